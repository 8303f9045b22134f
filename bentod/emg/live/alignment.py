"""Labels of a guided collection where the muscles really worked, rather than where the prompts stood."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.config_conditioning import Filter
from bentod.emg.classify.labelled import Names, Piece
from bentod.emg.conditioning import Conditioning
from bentod.emg.live.collection import Session
from bentod.emg.live.plan import Prompt
from bentod.emg.recognition import REST

SMOOTH_S = 0.05
"""Over which the envelope is averaged, centred."""

EARLY_S, LATE_S = 0.3, 1.0
"""Before and after a prompt a contraction may begin; reactions to a prompt take 0.15 to 0.5 s."""

SHARE = 0.25
"""Of the way from rest to the held contraction, at which it has begun and at which it ends."""

STEADY_S = 0.05
"""For so long the envelope must stay beyond that."""

MARGIN_S = 0.1
"""Just before an onset and just after a release, which belong to neither class."""

LEAST_OVER_REST = 1.5
"""Times the envelope at rest; a contraction that is weaker was not made."""

DELAY_S = 0.3
"""A reaction where none was seen in any repetition."""

Signal = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Moved:
    """What was found about one prompt."""

    prompt: Prompt
    onset: int  # sample of the session
    release: int
    over_rest: float  # envelope held, over that at rest just before
    aligned: bool  # the onset was seen; else it is a guess
    made: bool  # there was a contraction at all

    def delay_s(self, rate_hz: float) -> float:
        """From the prompt to the onset (s), below 0 if it came early."""
        return (self.onset - self.prompt.shown) / rate_hz

    def text(self, rate_hz: float) -> str:
        """What was done with its label, as a sentence."""
        who = f"{self.prompt.label}, repetition {self.prompt.repetition + 1}"
        way = f"{self.delay_s(rate_hz):+.2f}"
        if not self.made:
            return f"{who}: left out, since the signal was only {self.over_rest:.1f} times that at rest."
        if not self.aligned:
            return f"{who}: no onset was seen; its label was moved by a guess, {way} s."
        return f"{who}: its label was moved by {way} s."


def envelope(session: Session, filters: Sequence[Filter]) -> Signal:
    """Sum of the rectified channels (V), smoothed; shape (n,). Where it is missing it goes straight on."""
    volts = Conditioning(filters, session.rate_hz, session.samples.shape[1]).step(session.samples)
    if not filters:
        known_volts = (part[np.isfinite(part)] for part in volts.T)
        volts = volts - [np.median(part) if len(part) else 0.0 for part in known_volts]
    loud = np.abs(volts).sum(axis=1)
    known = np.flatnonzero(np.isfinite(loud))
    loud = np.interp(np.arange(len(loud)), known, loud[known]) if len(known) else np.zeros(len(loud))
    width = max(1, round(SMOOTH_S * session.rate_hz))
    return np.convolve(loud, np.ones(width) / width, "same")


def aligned(session: Session, filters: Sequence[Filter]) -> list[Moved]:
    """Where each contraction began and ended."""
    loud = envelope(session, filters)
    begins = [0, *(prompt.hidden for prompt in session.prompts)]
    found = [
        _found(loud, prompt, (begin + prompt.shown) // 2, session.rate_hz)
        for begin, prompt in zip(begins, session.prompts, strict=False)
    ]
    seen = [one.onset - one.prompt.shown for one in found if one.aligned and one.made]
    delay = round(float(np.median(seen))) if seen else round(DELAY_S * session.rate_hz)
    return [one if one.aligned else _guessed(one, delay) for one in found]


def _found(loud: Signal, prompt: Prompt, resting: int, rate_hz: float) -> Moved:
    """`resting`: the sample from which on, up to the prompt, the muscles are taken to rest."""
    hold = prompt.hidden - prompt.shown
    # Who begins early is at rest for a part of that only.
    rest = float(np.quantile(loud[resting : prompt.shown], 0.25))
    held = float(np.median(loud[prompt.shown + hold // 2 : prompt.hidden]))
    over = held / rest if rest > 0 else float("inf") if held > 0 else 0.0
    level, steady = rest + SHARE * (held - rest), round(STEADY_S * rate_hz)
    start = max(0, prompt.shown - round(EARLY_S * rate_hz))
    stop = prompt.shown + min(round(LATE_S * rate_hz), hold // 2)
    onset = _first_run(loud[start : stop + steady] > level, steady)
    end = prompt.shown + hold // 2
    quiet = _first_run(loud[end : prompt.hidden + round(LATE_S * rate_hz)] < level, steady)
    release = end + quiet if quiet >= 0 else prompt.hidden
    # One that is there from the first sample has begun before anybody looked.
    seen = onset > 0 and start + onset < release
    made = over >= LEAST_OVER_REST
    return Moved(prompt, start + onset if seen else prompt.shown, release, over, seen, made)


def _guessed(one: Moved, delay: int) -> Moved:
    onset = min(one.prompt.shown + delay, one.release)
    return Moved(one.prompt, onset, one.release, one.over_rest, False, one.made)


def _first_run(flags: NDArray[np.bool_], length: int) -> int:
    """Where `length` flags in a row first begin; -1 if they never do."""
    sums = np.convolve(flags, np.ones(max(length, 1)), "valid")
    found = np.flatnonzero(sums >= length - 0.5)
    return int(found[0]) if len(found) else -1


def labelled(session: Session, moved: Sequence[Moved], condition: str) -> tuple[Piece, Names]:
    """The session with a label at each sample, and what was prompted at each."""
    count, margin = len(session.samples), round(MARGIN_S * session.rate_hz)
    longest = max([len(REST), *(len(one.prompt.label) for one in moved)])
    labels = np.full(count, REST, f"<U{longest}")
    prompted = labels.copy()
    repetitions = np.full(count, moved[-1].prompt.repetition, np.int64)
    for one in reversed(moved):  # so a rest counts to the contraction after it
        prompted[one.prompt.shown : one.prompt.hidden] = one.prompt.label
        repetitions[: one.release + margin] = one.prompt.repetition
        labels[max(0, one.onset - margin) : one.release + margin] = ""
        if one.made:
            labels[one.onset : one.release] = one.prompt.label
        else:
            labels[one.prompt.shown : one.prompt.hidden] = ""
    return Piece(session.samples, labels, repetitions, np.full(count, condition)), prompted
