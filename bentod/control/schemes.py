"""What the config says about pairs and single sites, as schemes that follow every sample of their sites."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Protocol

from bentod.config_sites import CoContraction, Pair, Pulse, SingleSite, Toggled
from bentod.control.candidates import Candidates, Pacing
from bentod.control.cocontraction import CoContractions, Squeeze
from bentod.control.course import Heard
from bentod.control.proportional import Site, difference
from bentod.control.pulse import Beat, Pulses
from bentod.control.single_site import Alternate, OneWay, TwoState
from bentod.control.switching import BACKWARD, ENDED_S, FORWARD, QUIET_S, RELEASE, ToggleSite, Toggling
from bentod.control.two_sites import FirstOver, TwoSites, greatest

LAPSE_S = 0.05
"""s that a muscle must be quiet for to be known to have let go; a shorter dip is the signal's scatter."""

STEPS = {"forward": FORWARD, "backward": BACKWARD}


class Drive(Protocol):
    """Sites that drive a group."""

    def step(self, heard: Heard) -> list[int]:
        """The toggles in a stretch, `FORWARD` or `BACKWARD`, in no order."""
        ...

    def effort(self, efforts: Mapping[str, float]) -> float:
        """What the sites ask, -1..1, from the newest effort of each, 0..1."""
        ...

    def tense(self, efforts: Mapping[str, float]) -> bool:
        """Whether a muscle is contracted, be it that it asks for nothing."""
        ...

    def reset(self) -> None:
        """Forget everything."""
        ...


class Scheme:
    """How muscles drive and toggle one group."""

    def __init__(self, table: Toggled, drive: Drive, rate_hz: float) -> None:
        self.group = table.group
        self._table = table
        self._drive = drive
        self._rate_hz = rate_hz
        self._toggling = Toggling(())

    def step(self, heard: Heard) -> list[int]:
        """The toggles in a stretch, `FORWARD` or `BACKWARD`, in no order, since they commute.

        `heard`: all samples since the last step.
        """
        self._toggling.sites = tuple(self._toggle_sites(heard.sites))
        toggled = self._toggling.step(heard.levels)
        return [step for steps in toggled.values() for step in steps] + self._drive.step(heard)

    def effort(self, efforts: Mapping[str, float]) -> float:
        """What the sites ask of the group, -1..1, from the newest effort of each, 0..1."""
        return self._drive.effort(efforts)

    def tense(self, efforts: Mapping[str, float]) -> bool:
        """Whether a muscle that drives or may toggle is contracted, be it that it asks for nothing."""
        return self._drive.tense(efforts) or self._toggling.undecided

    def reset(self) -> None:
        """Forget everything: whatever is contracted now is nobody's toggle."""
        self._drive.reset()
        self._toggling.reset()

    def _toggle_sites(self, sites: Mapping[str, Site]) -> Iterator[ToggleSite]:
        """The toggle sites as they are set now. Raises ConfigError: one of them makes no sense."""
        table = self._table
        long = count(table.long_s, self._rate_hz) if table.toggle == table.toggle_back else 0
        steps = {table.toggle_back: BACKWARD, table.toggle: FORWARD}
        for name, step in steps.items():
            if name is not None:
                yield self._toggle_site(sites[name], step, long)

    def _toggle_site(self, site: Site, step: int, long: int) -> ToggleSite:
        release = min(site.release, RELEASE)
        quiet, ended = (count(seconds, self._rate_hz) for seconds in (QUIET_S, ENDED_S))
        return ToggleSite(
            site.name, site.channel, site.gain, site.threshold, release, quiet, step, long, ended
        )


def schemes_of(
    pairs: Sequence[Pair], single_sites: Sequence[SingleSite], rate_hz: float
) -> tuple[Scheme, ...]:
    """Schemes for tables whose sites exist; `rate_hz`: of the samples."""
    return (
        *(Scheme(pair, _two_sites(pair, rate_hz), rate_hz) for pair in pairs),
        *(Scheme(single, _single_site(single, rate_hz), rate_hz) for single in single_sites),
    )


def count(seconds: float, rate_hz: float) -> int:
    """Samples in so many seconds, one at least."""
    return max(round(seconds * rate_hz), 1)


def _two_sites(pair: Pair, rate_hz: float) -> TwoSites:
    found: list[tuple[str, Candidates]] = []
    if pair.co_contraction:
        found.append((pair.positive, _co_contractions(pair.co_contraction, rate_hz)))
    if pair.pulse:
        found.append((pair.pulse.site, _pulses(pair.pulse, rate_hz)))
    rules = {"difference": difference, "greatest": greatest}
    return TwoSites(
        (pair.positive, pair.negative), rules.get(pair.rule) or FirstOver(count(LAPSE_S, rate_hz)), found
    )


def _co_contractions(table: CoContraction, rate_hz: float) -> CoContractions:
    together, dwell = count(table.together_s, rate_hz), count(table.dwell_s, rate_hz)
    return CoContractions(Squeeze(_pacing(table, rate_hz), together, dwell, table.balance))


def _pulses(table: Pulse, rate_hz: float) -> Pulses:
    rise, least, within = (count(s, rate_hz) for s in (table.rise_s, table.least_s, table.within_s))
    return Pulses(Beat(_pacing(table, rate_hz), table.strong, rise, least, within))


def _pacing(table: CoContraction | Pulse, rate_hz: float) -> Pacing:
    rest, lapse, refractory = (count(s, rate_hz) for s in (table.rest_s, LAPSE_S, table.refractory_s))
    return Pacing(STEPS[table.direction], rest, lapse, refractory)


def _single_site(table: SingleSite, rate_hz: float) -> TwoState | Alternate:
    weak = 1 if table.weak == "positive" else -1
    ways = OneWay(weak, table.strong, count(table.decide_s, rate_hz), count(table.rest_s, rate_hz))
    return TwoState(table.site, ways) if table.rule == "two_state" else Alternate(table.site, ways)
