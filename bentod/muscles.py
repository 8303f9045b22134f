"""From the newest samples to what the wearer asks: effort per group, toggles per group (thesis A.1.2)."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace

from bentod.config_sites import Pair, SingleSite
from bentod.config_sites import Site as SiteConfig
from bentod.control.course import Heard
from bentod.control.operators import Asked
from bentod.control.proportional import Envelope, Levels, Loudness, Proportional, Site
from bentod.control.rest import RestFirst
from bentod.control.schemes import schemes_of
from bentod.control.switching import BACKWARD, FORWARD
from bentod.emg.classify.model import Model
from bentod.emg.contact import Wired
from bentod.emg.electrodes import Electrodes
from bentod.emg.feed import Feed
from bentod.emg.live.leads import unwatched
from bentod.emg.live.recogniser import Recogniser
from bentod.errors import BadRequest, ConfigError, nearest
from bentod.frames import EmgFrame, Samples, Value


@dataclass(frozen=True, slots=True)
class Look:
    """What the muscles say in one tick."""

    efforts: Mapping[str, float]  # by group, -1..1
    toggles: Sequence[str]  # groups, once for each toggle
    frame: EmgFrame
    toggles_back: Sequence[str] = ()  # groups, once for each toggle to the joint before
    tense: Collection[str] = ()  # groups whose muscles are contracted, be it that they ask for nothing
    moves: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Of groups that are moved by a recognised class: by joint, the share of its speed that effort 1 asks."""

    @property
    def asked(self) -> Asked:
        """What they ask of the groups."""
        return Asked(self.efforts, self.toggles, self.toggles_back, self.tense, self.moves)


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
        single_sites: Sequence[SingleSite] = (),
        loudness: Loudness | None = None,
        electrodes: Electrodes | None = None,
    ) -> None:
        """By default the mean absolute value, over `window` samples, of signals as they come."""
        self.paused = False
        self._pauses = 0
        self.tell: Callable[[str, Mapping[str, Value]], None] = lambda *_: None
        """Told of leads that come off or are on again: a sentence and its data."""
        self.recognition: Recogniser | None = None
        """What tells classes of contractions apart, if the config asks for it."""
        self.interventions = 0
        """How often the arm was stopped, paused, released and so on, as of this tick."""
        self._electrodes = electrodes
        self._feed = feed
        self._pairs = tuple(pairs)
        self._single_sites = tuple(single_sites)
        self._loudness = loudness or Envelope(window)
        self._proportional = Proportional(
            [Site(s.name, s.channel, s.gain, s.threshold_v, s.max_v, s.release) for s in sites]
        )
        rate_hz = feed.ring.rate_hz if feed else 0.0
        self._schemes = schemes_of(pairs, single_sites, rate_hz)
        self._rest = RestFirst(rate_hz)
        self._next = 0
        self._toggles = 0
        self._unwatched: Sequence[Wired] = ()
        self._watched_for: Model | None = None
        self._watch_leads()

    def look(self, now: float) -> Look:
        """Work through every sample since the last look; `now`: monotonic s.

        A source that is dead, late, lifeless or not finite moves nothing, and starts from rest after it; one
        that was lost must also be seen at rest. Contractions that had not yet been decided are forgotten.
        """
        feed = self._feed
        if feed is None:
            return Look(
                {}, (), EmgFrame(False, self.paused, "The config has no [emg] table.", 0, 0.0, 0, {}, 0)
            )
        if self.recognition and self.recognition.model is not self._watched_for:
            self._watched_for = self.recognition.model
            self._watch_leads()
        problem = feed.problem(now) or self._lifeless(feed)
        self._rest.watch(now, problem, feed.openings)
        heard = self._hear(feed, problem)
        toggled = [(scheme.group, step) for scheme in self._schemes for step in scheme.step(heard)]
        waiting = self._rest.step(self._attached(), heard.levels)
        if self.paused:
            self._forget()
        efforts = self._proportional.newest()
        obeyed = not (self.paused or problem or waiting)
        on, back = ([g for g, one in toggled if one == step and obeyed] for step in (FORWARD, BACKWARD))
        self._toggles += len(on) + len(back)
        tense = {scheme.group for scheme in self._schemes if scheme.tense(efforts)}
        told = problem or waiting or (self._electrodes.problem if self._electrodes else "")
        frame = self._frame(feed, now, told, not problem, efforts)
        look = Look(self._by_group(efforts) if obeyed else {}, on, frame, back, tense)
        return self._with_classes(look, now, problem, obeyed) if self.recognition else look

    def pause(self, on: bool) -> None:
        """Let them drive nothing, or let them drive; counted, so that nobody undoes what others asked."""
        self.paused = on
        self._pauses += 1

    def recognise(self, recogniser: Recogniser) -> None:
        """Let classes of contractions move what they are meant to, besides what sites drive."""
        self.recognition = recogniser
        recogniser.tell = lambda text, data: self.tell(text, data)

    @property
    def recognised(self) -> Collection[str]:
        """Groups that are moved by classes of contractions."""
        return self.recognition.table.groups() if self.recognition else ()

    def _with_classes(self, look: Look, now: float, problem: str, obeyed: bool) -> Look:
        if self.recognition is None:
            return look
        problem = problem or (self._electrodes.problem if self._electrodes else "")
        wanted = self.recognition.look(now, problem, obeyed, self.interventions)
        frame = replace(look.frame, recognition=wanted.frame)
        if self.recognition.collection:
            return Look({}, (), frame)
        tense = {*look.tense, *wanted.tense}
        efforts = {**look.efforts, **wanted.efforts}
        return replace(look, efforts=efforts, moves=wanted.moves, frame=frame, tense=tense)

    def _hear(self, feed: Feed, problem: str) -> Heard:
        """Every sample since the last look; none, and all before forgotten, if there is a problem."""
        samples = feed.since(self._next)
        late = feed.ring.oldest_index > self._next
        self._next = feed.ring.next_index
        if problem or late:
            self._loudness.reset()
            self._proportional.reset()
            self._forget()
        conditioned = self._condition(samples, feed.ring.next_index - len(samples))
        levels = self._loudness.step(conditioned[:0] if problem else conditioned)
        sites = {site.name: site for site in self._proportional.sites}
        return Heard(sites, levels, self._proportional.step(levels))

    def _condition(self, samples: Samples, first: int) -> Samples | Levels:
        """What sites are judged by; `first`: index of the first of `samples`."""
        if self._electrodes is None:
            return samples
        conditioned = self._electrodes.step(samples, first)
        for turn in self._electrodes.take_turns():
            self.tell(turn.text, {"site": turn.site, "channel": turn.channel, "reason": turn.reason})
        return conditioned

    def _attached(self) -> Sequence[Site]:
        """Sites whose leads are on; all when none is."""
        off = self._electrodes.off if self._electrodes else {}
        return [site for site in self._proportional.sites if site.name not in off] or self._proportional.sites

    def _watch_leads(self) -> None:
        sites = [
            Wired(s.name, s.channel, s.threshold / s.gain, s.maximum / s.gain)
            for s in self._proportional.sites
        ]
        if self.recognition:
            known = [site.channel for site in sites]
            self._unwatched = unwatched(self.recognition.model, self.recognition.channels, known)
        if self._electrodes:
            self._electrodes.watch([*sites, *self._unwatched])

    def _forget(self) -> None:
        for scheme in self._schemes:
            scheme.reset()

    def describe(self) -> dict[str, Value]:
        """Rate, sites with their parameters, pairs, and whether EMG is paused, as clients see them."""
        sites: list[Value] = [
            {
                "name": s.name,
                "channel": s.channel,
                "gain": s.gain,
                "threshold_v": s.threshold,
                "max_v": s.maximum,
                "release": s.release,
            }
            for s in self._proportional.sites
        ]
        rate = self._feed.ring.rate_hz if self._feed else 0.0
        pairs: list[Value] = [pair.model_dump() for pair in self._pairs]
        single: list[Value] = [one.model_dump() for one in self._single_sites]
        return {
            "paused": self.paused,
            "pauses": self._pauses,
            "rate_hz": rate,
            "sites": sites,
            "pairs": pairs,
            "single_sites": single,
        }

    def change_site(
        self,
        name: str,
        gain: float | None = None,
        threshold: float | None = None,
        maximum: float | None = None,
        release: float | None = None,
    ) -> None:
        """Change some of a site's gain, threshold (V), maximum (V) and release from the next tick on.

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
                release=old.release if release is None else release,
            )
        except ConfigError as error:
            raise BadRequest(str(error), _FIELDS.get(error.field, error.field)) from error
        self._proportional.sites = tuple(sites.values())
        self._watch_leads()

    def levels(self) -> dict[str, Value]:
        """How loud each site is (V after gain, nil: not known), at which sample, and which leads are off."""
        volts = self._proportional.loudness().items()
        known: dict[str, Value] = {name: None if math.isnan(level) else level for name, level in volts}
        off: dict[str, Value] = {**self._electrodes.off} if self._electrodes else {}
        return {"index": self._next, "paused": self.paused, "levels_v": known, "leads_off": off}

    def _lifeless(self, feed: Feed) -> str:
        """Why a site that is above its threshold is no muscle's; empty when all may be."""
        free = self._electrodes is not None and self._electrodes.mean_free
        leasts = [(s.channel, s.threshold / s.gain) for s in self._proportional.sites]
        leasts += [(one.channel, one.threshold) for one in self._unwatched]
        reasons = (feed.lifeless(channel, least, free) for channel, least in leasts)
        return next(filter(None, reasons), "")

    def _by_group(self, efforts: Mapping[str, float]) -> dict[str, float]:
        """Schemes of one group add up, as the sites of a pair do: each works alone, and opposites cancel."""
        sums = dict.fromkeys((scheme.group for scheme in self._schemes), 0.0)
        for scheme in self._schemes:
            sums[scheme.group] += scheme.effort(efforts)
        return {group: min(max(effort, -1.0), 1.0) for group, effort in sums.items()}

    def _frame(
        self, feed: Feed, now: float, problem: str, alive: bool, efforts: Mapping[str, float]
    ) -> EmgFrame:
        age = min(feed.age(now), 1e6)  # a number on the wire even before the first sample
        return EmgFrame(alive, self.paused, problem, self._next, age, feed.dropped, efforts, self._toggles)
