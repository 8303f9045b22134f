"""Leads that are off: what their channels show is mains hum, slow swings, or nothing at all."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from bentod.config_conditioning import Leads
from bentod.emg.conditioning import Volts
from bentod.emg.signs import ALIKE
from bentod.frames import Samples

LOOK_S = 0.2
"""s that are looked at: ten periods of the mains. A muscle's power, spread over 100 Hz and more, has some 40
independent values in it, of which hum has two; so that it would never reach the share that hum has."""

LEAST_LOOK = 40
"""Samples that are looked at at least."""

HOP_S = 0.05
"""s from one look to the next."""

BACK_S = 0.5
"""s at rest and without a sign before a lead is on again: while it is pressed on it comes and goes, and what
comes and goes must not move an arm unasked."""

MAINS_HZ = (50.0, 60.0)
HARMONICS = 3
"""Tones that hum is looked for in: the mains', twice and three times that."""

SLOW_DEGREE = 4
"""Of the polynomials that take up what is slower than 10 Hz in a look: two turns of it."""

USABLE = 0.98
"""Share of half the rate below which a tone can be told."""


SLOW = (
    "{:.0%} of its power is slower than 10 Hz: the lead is off or moves, or the source has an offset that a "
    "high-pass would take away"
)
HUM = "{:.0%} of its power is hum of {:g} Hz, so the lead is off"

TINY = 1e-300
"""V²: keeps a share of nothing finite."""

Each: TypeAlias = NDArray[np.float64]
"""One number a site, shape (n,)."""


@dataclass(frozen=True, slots=True)
class Wired:
    """A site as its lead is judged: everything before its gain."""

    name: str
    channel: int
    threshold: float  # V, below which it asks for nothing
    maximum: float  # V, of a full contraction


@dataclass(frozen=True, slots=True)
class Turn:
    """A lead has come off or is on again, or a channel has fallen silent or is alive again."""

    site: str
    channel: int
    reason: str  # a sentence; empty when all is well again

    @property
    def text(self) -> str:
        """What happened, as a sentence."""
        where = f"site {self.site} (channel {self.channel})"
        return f"EMG {where}: {self.reason}" if self.reason else f"EMG {where} is well again"


class Signs:
    """What a muscle's signal never is: one tone, or slow."""

    def __init__(self, leads: Leads, rate_hz: float) -> None:
        self.length = max(LEAST_LOOK, math.ceil(LOOK_S * rate_hz))
        """Samples of a look."""
        self._leads = leads
        places = np.linspace(-1.0, 1.0, self.length)
        self._slow = np.linalg.qr(np.polynomial.legendre.legvander(places, SLOW_DEGREE))[0]
        self._hums = {hz: tones for hz in MAINS_HZ if (tones := self._tones(hz, rate_hz)) is not None}

    def _tones(self, hz: float, rate_hz: float) -> Volts | None:
        """An orthonormal base of the hum of a mains frequency, free of what is slow."""
        phase = 2 * np.pi * hz / rate_hz * np.arange(self.length)
        carried = [h for h in range(1, HARMONICS + 1) if h * hz < USABLE * rate_hz / 2]
        if not carried:
            return None
        waves = np.stack([wave(h * phase) for h in carried for wave in (np.cos, np.sin)], axis=1)
        return np.linalg.qr(waves - self._slow @ (self._slow.T @ waves))[0]

    def asked(self, look: Volts, least: Each) -> list[str]:
        """Why each signal of a look (V, shape (length, n)) is no muscle's; empty where it may be.

        What is not louder than `least` (V, mean magnitude, shape (n,)) asks for nothing.
        """
        told = self.humming(look, least)
        for i in np.flatnonzero(_volume(look) > least):
            slow = np.sum((self._slow.T @ look[:, i]) ** 2) / (np.sum(look[:, i] ** 2) + TINY)
            if slow > self._leads.slow:
                told[i] = SLOW.format(slow)
        return told

    def humming(self, look: Volts, least: Each) -> list[str]:
        """Why each signal (as above) is nothing but mains hum louder than `least`; empty where it is not."""
        told = [""] * look.shape[1]
        for i in np.flatnonzero(_volume(look) > least):
            rest = look[:, i] - self._slow @ (self._slow.T @ look[:, i])
            power = np.sum(rest**2) + TINY
            shares = {hz: np.sum((tones.T @ rest) ** 2) / power for hz, tones in self._hums.items()}
            hz = max(shares, key=lambda hz: shares[hz], default=0.0)
            if shares and shares[hz] > self._leads.hum and np.mean(np.abs(rest)) > least[i]:
                told[i] = HUM.format(shares[hz], hz)
        return told


def _volume(look: Volts) -> Each:
    return np.asarray(np.mean(np.abs(look), axis=0))


def _stuck(newest: Volts) -> NDArray[np.bool_]:
    """Which channels hold one value, which is for `signs.lifeless` to judge."""
    return np.asarray(np.ptp(newest, axis=0) <= ALIKE * np.max(np.abs(newest), axis=0))


class Contact:
    """Which sites have a lead that is off, judged every `HOP_S` by sample index.

    The conditioned signal is judged where it would ask for something; hum also before the filters, if it is
    louder than any good contact's. A channel that stays at one value asks for nothing, and is only told.
    """

    def __init__(self, leads: Leads, rate_hz: float) -> None:
        self.sites: Sequence[Wired] = ()
        """May be replaced between two steps."""
        self.off: dict[str, str] = {}
        """Why, by site whose lead is off now."""
        self.flat: dict[str, str] = {}
        """Why, by site whose channel has fallen silent."""
        self._leads = leads
        self._signs = Signs(leads, rate_hz)
        self._hop = max(1, round(HOP_S * rate_hz))
        self._hops_back = math.ceil(BACK_S / HOP_S)
        self._good: dict[str, int] = {}  # hops at rest and without a sign, by site
        self._next = self._hop  # samples to the next look
        self._looks: tuple[Volts, Volts] | None = None  # raw, conditioned; the newest are last
        self._extremes: NDArray[np.float64] | None = None  # least and greatest, shape (2, hops, channels)
        self._hops = 0
        self._stuck: NDArray[np.intp] = np.zeros(1, np.intp)  # looks that a stuck wire is still part of
        self._turns: list[Turn] = []

    def step(self, raw: Samples | Volts, conditioned: Volts) -> Volts:
        """`conditioned` (V, shape (n, channels)) with NaN where a site's lead is off.

        `raw`: the same samples before the filters. Both are all that came since the last step.
        """
        if not self._leads.enabled:
            return conditioned
        out, start = conditioned.copy(), 0
        while start < len(raw):
            stop = min(start + self._next, len(raw))
            out[start:stop, [site.channel for site in self.sites if site.name in self.off]] = np.nan
            self._take(raw[start:stop].astype(np.float64), conditioned[start:stop])
            self._next -= stop - start
            if not self._next:
                self._judge()
                self._next = self._hop
            start = stop
        return out

    def take_turns(self) -> list[Turn]:
        """What has changed since the last call."""
        turns, self._turns = self._turns, []
        return turns

    def _take(self, raw: Volts, conditioned: Volts) -> None:
        keep = max(self._signs.length, self._hop)
        before = self._looks or (raw[:0], conditioned[:0])
        new = zip(before, (raw, conditioned), strict=True)
        one, other = (np.concatenate(both)[-keep:] for both in new)
        self._looks = one, other

    def _judge(self) -> None:
        """One look at every site whose samples are all known, none of them from a wire that was stuck."""
        if self._looks is None:
            return
        self._judge_silence(self._looks[0][-self._hop :])
        length = self._signs.length
        raw, conditioned = (look[-length:] for look in self._looks)
        hops = math.ceil(length / self._hop) + 1
        self._stuck = np.where(_stuck(conditioned[-self._hop :]), hops, np.maximum(self._stuck - 1, 0))
        known = np.all(np.isfinite(raw) & np.isfinite(conditioned), axis=0) & (self._stuck == 0)
        sites = [site for site in self.sites if known.item(site.channel)]
        if len(raw) < length or not sites:
            return
        channels = [site.channel for site in sites]
        raw, conditioned = raw[:, channels], conditioned[:, channels]
        threshold = np.array([site.threshold for site in sites])
        asked = self._signs.asked(conditioned, threshold)
        heard = self._signs.humming(raw, self._leads.hum_max * np.array([site.maximum for site in sites]))
        resting = (_volume(conditioned[-self._hop :]) <= threshold).tolist()
        for site, one, other, at_rest in zip(sites, asked, heard, resting, strict=True):
            self._decide(site, one or other, at_rest)

    def _judge_silence(self, newest: Volts) -> None:
        """`newest`: what has come since the last look, raw (V, shape (hop, channels))."""
        if self._extremes is None:
            hops = math.ceil(self._leads.flat_s / HOP_S)
            self._extremes = np.full((2, hops, newest.shape[1]), np.nan)
        self._extremes[:, self._hops % self._extremes.shape[1]] = newest.min(axis=0), newest.max(axis=0)
        self._hops += 1
        spread: Each = np.asarray(self._extremes[1].max(axis=0) - self._extremes[0].min(axis=0))
        told = f"no change for {self._leads.flat_s:g} s, as of a lead that is off or an input that is shorted"
        for site in self.sites:
            self._tell(self.flat, site, told if spread[site.channel] <= self._leads.flat_v else "")

    def _decide(self, site: Wired, reason: str, at_rest: bool) -> None:
        """A sign takes a site off at once; it is back after `BACK_S` at rest without one."""
        self._good[site.name] = self._good.get(site.name, 0) + 1 if at_rest and not reason else 0
        if reason or self._good[site.name] >= self._hops_back:
            self._tell(self.off, site, reason)

    def _tell(self, known: dict[str, str], site: Wired, reason: str) -> None:
        """Keep why, and note a turn when it begins or ends."""
        if bool(reason) is not (site.name in known):
            self._turns.append(Turn(site.name, site.channel, reason))
            if not reason:
                del known[site.name]
        if reason:
            known.setdefault(site.name, reason)
