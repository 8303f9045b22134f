"""From the newest samples to what the wearer asks: effort per group, toggles per group (thesis A.1.2)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from bentod.config_tables import Pair
from bentod.config_tables import Site as SiteConfig
from bentod.control.operators import Asked
from bentod.control.proportional import Proportional, Site, difference
from bentod.control.switching import ToggleSite, Toggling
from bentod.emg.feed import Feed
from bentod.errors import BadRequest, ConfigError, nearest
from bentod.frames import EmgFrame, Value


@dataclass(frozen=True, slots=True)
class Look:
    """What the muscles say in one tick."""

    efforts: Mapping[str, float]  # by group, -1..1
    toggles: Sequence[str]  # groups, once for each toggle
    frame: EmgFrame

    @property
    def asked(self) -> Asked:
        """What they ask of the groups."""
        return Asked(self.efforts, self.toggles)


_FIELDS = {"threshold": "threshold_v", "maximum": "max_v"}
"""What clients call a site's parameters."""


class Muscles:
    """The wearer's muscles as the controller sees them; without a feed there is no wearer."""

    def __init__(
        self,
        feed: Feed | None = None,
        sites: Sequence[SiteConfig] = (),
        pairs: Sequence[Pair] = (),
        window: int = 10,
    ) -> None:
        self.paused = False
        self._feed = feed
        self._pairs = tuple(pairs)
        settings = [Site(s.name, s.channel, s.gain, s.threshold_v, s.max_v) for s in sites]
        self._proportional = Proportional(settings, window)
        self._toggling = Toggling([], window)
        self._next = 0
        self._toggles = 0
        self._set_toggle_sites()

    def look(self, now: float) -> Look:
        """Work through every sample since the last look; `now`: monotonic s.

        A source that is dead, late, lifeless or not finite moves nothing, and starts from rest after it.
        """
        if self._feed is None:
            return Look(
                {}, (), EmgFrame(False, self.paused, "The config has no [emg] table.", 0, 0.0, 0, {}, 0)
            )
        samples = self._feed.since(self._next)
        self._next = self._feed.ring.next_index
        problem = self._feed.problem(now) or self._lifeless(self._feed)
        if problem:
            self._proportional.reset()
            self._toggling.reset()
            samples = samples[:0]
        efforts = self._proportional.step(samples)
        toggled = self._toggling.step(samples)
        obeyed = not self.paused and not problem
        toggles = (
            [p.group for p in self._pairs if p.toggle for _ in range(toggled[p.toggle])] if obeyed else []
        )
        self._toggles += len(toggles)
        return Look(self._by_group(efforts) if obeyed else {}, toggles, self._frame(now, problem, efforts))

    def describe(self) -> dict[str, Value]:
        """Rate, sites with their parameters, pairs, and whether EMG is paused, as clients see them."""
        sites: list[Value] = [
            {
                "name": s.name,
                "channel": s.channel,
                "gain": s.gain,
                "threshold_v": s.threshold,
                "max_v": s.maximum,
            }
            for s in self._proportional.sites
        ]
        rate = self._feed.ring.rate_hz if self._feed else 0.0
        pairs: list[Value] = [pair.model_dump() for pair in self._pairs]
        return {"paused": self.paused, "rate_hz": rate, "sites": sites, "pairs": pairs}

    def change_site(
        self, name: str, gain: float | None, threshold: float | None, maximum: float | None
    ) -> None:
        """Change some of a site's gain, threshold (V) and maximum (V) from the next tick on.

        Raises:
            BadRequest: there is no such site, or the values do not go together.
        """
        sites = {site.name: site for site in self._proportional.sites}
        if name not in sites:
            raise BadRequest(f"there is no EMG site '{name}'{nearest(name, sites)}", "site")
        old = sites[name]
        try:
            sites[name] = replace(
                old,
                gain=old.gain if gain is None else gain,
                threshold=old.threshold if threshold is None else threshold,
                maximum=old.maximum if maximum is None else maximum,
            )
        except ConfigError as error:
            raise BadRequest(str(error), _FIELDS.get(error.field, error.field)) from error
        self._proportional.sites = tuple(sites.values())
        self._set_toggle_sites()

    def _lifeless(self, feed: Feed) -> str:
        """Why a site that is above its threshold is no muscle's; empty when all may be."""
        reasons = (feed.lifeless(s.channel, s.threshold / s.gain) for s in self._proportional.sites)
        return next(filter(None, reasons), "")

    def _set_toggle_sites(self) -> None:
        named = {pair.toggle for pair in self._pairs}
        self._toggling.sites = tuple(
            ToggleSite(s.name, s.channel, s.gain, s.threshold)
            for s in self._proportional.sites
            if s.name in named
        )

    def _by_group(self, efforts: Mapping[str, float]) -> dict[str, float]:
        """Pairs of one group add up, as the sites of a pair do: each works alone, and opposites cancel."""
        sums = dict.fromkeys((pair.group for pair in self._pairs), 0.0)
        for pair in self._pairs:
            sums[pair.group] += difference(efforts[pair.positive], efforts[pair.negative])
        return {group: min(max(effort, -1.0), 1.0) for group, effort in sums.items()}

    def _frame(self, now: float, problem: str, efforts: Mapping[str, float]) -> EmgFrame:
        feed = self._feed
        if feed is None:
            raise AssertionError("a frame of muscles needs a feed")
        age = min(feed.age(now), 1e6)  # a number on the wire even before the first sample
        return EmgFrame(
            not problem, self.paused, problem, self._next, age, feed.dropped, efforts, self._toggles
        )
