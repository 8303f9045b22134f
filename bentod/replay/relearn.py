"""Learners and assist over recorded ticks: bit for bit as they were live, or with other parameters."""

import itertools
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace

from bentod.config import Config
from bentod.frames import Command, Event, Frame, JointFrame, JointState, State, Value
from bentod.furnish import mind_of
from bentod.learn.horde import HasTime
from bentod.learn.signals import Percept
from bentod.learn.snapshot import Keepable
from bentod.replay.player import Source

ASSIST_KEYS = (
    "mode",
    "k",
    "timescale",
    "velocity_limit_rad_s",
    "manual_after_toggle_s",
    "timescale_by",
    "toggle_reward",
    "contact_reward",
    "options",
)
"""What `assist_set` may change, and events of kind "assist" tell."""


@dataclass(frozen=True, slots=True)
class Tick:
    """One recorded tick: its frame, and the events that it published."""

    frame: Frame
    events: tuple[Event, ...]


def ticks(entries: Iterable[object]) -> Iterator[Tick]:
    """Frames, each with the events that follow it up to the next one; other entries are left out."""
    frame: Frame | None = None
    events: list[Event] = []
    for entry in entries:
        if isinstance(entry, Event):
            events.append(entry)
        elif isinstance(entry, Frame):
            if frame is not None:
                yield Tick(frame, tuple(events))
            frame, events = entry, []
    if frame is not None:
        yield Tick(frame, tuple(events))


class Thought:
    """A recording as something to be played, with what is predicted and asked by the assist this time."""

    def __init__(self, tape: Source, relearner: "Relearner") -> None:
        self._tape = tape
        self._relearner = relearner

    def entries(self, start: float | None = None) -> Iterator[object]:
        """As those of the recording. Where playing begins or goes on elsewhere, nothing is learned across."""
        waiting: list[object] = []
        gap = start is not None
        for entry in self._tape.entries(start):
            if isinstance(entry, Frame):
                yield from self._think(waiting)
                waiting = [replace(entry, gap=entry.gap or gap)]
                gap = False
            else:
                waiting.append(entry)
        yield from self._think(waiting)

    def _think(self, entries: list[object]) -> Iterator[object]:
        for tick in ticks(entries):
            yield self._relearner.step(tick)
        yield from (entry for entry in entries if not isinstance(entry, Frame))


class Relearner:
    """The mind of `config`, fed with what a recording says that the arm read and the operator did.

    With the config of the recording it predicts and asks exactly what it did live, as long as it sees every
    tick from the daemon's first on. `kept`: keys of the assist whose recorded changes are to be ignored,
    because other values are tried.
    """

    def __init__(self, config: Config, kept: Collection[str] = ()) -> None:
        specs = [joint.spec() for joint in config.joints]
        self._names = [spec.name for spec in specs]
        self._mind = mind_of(config)
        self.learners: Keepable | None = self._mind.known
        """What can be kept of what is learned; None if there is nothing of that kind."""
        self._kept = frozenset(kept)
        self._first = config.assist.group if config.assist else ""  # of old recordings
        self._shed = 0

    def step(self, tick: Tick) -> Frame:
        """The frame of `tick` with what is predicted and asked by the assist this time.

        A tick that broke is passed on as it is: what it read was not recorded.
        """
        frame = tick.frame
        for event in tick.events:
            self._take(event)
        if not frame.whole:
            return frame
        state = _state(frame)
        has_time = self._budget(frame)
        percept = Percept(frame.tick, frame.time, frame.gap, state, frame.emg, frame.groups)
        self._mind.predict(percept, has_time)
        attended = {
            it.group or self._first: self._names.index(it.attended) if it.attended else None
            for it in (frame.assist, *frame.more_assists)
        }
        helped = self._mind.assist_beside(percept, attended)
        self._mind.learn(has_time)
        joints = tuple(
            self._joint(index, joint, helped.wishes.get(index)) for index, joint in enumerate(frame.joints)
        )
        first, *others = helped.frames
        learn = self._mind.frame()
        return replace(frame, assist=first, more_assists=tuple(others), joints=joints, learn=learn)

    def _budget(self, frame: Frame) -> HasTime:
        """As many learners have time as had it in this tick: those that are left out are always the last."""
        left_out, self._shed = frame.shed - self._shed, frame.shed
        asked = itertools.count(1)
        units = self._mind.units
        return lambda: next(asked) <= units - left_out

    def _joint(self, index: int, joint: JointFrame, wish: Command | None) -> JointFrame:
        others = {source: asked for source, asked in joint.asked.items() if source != "assist"}
        asked = others if wish is None else {**others, "assist": wish}
        return replace(joint, asked=asked, predictions=self._mind.predictions(index))

    def _take(self, event: Event) -> None:
        if event.kind == "group":
            self._mind.toggled(str(event.data.get("group", "")), event.time)
        elif event.kind == "assist":
            keys = [key for key in ASSIST_KEYS if key in event.data and key not in self._kept]
            told = {key: event.data[key] for key in keys}
            group = event.data.get("group")
            self._mind.change(told, group if isinstance(group, str) else None)
        elif event.kind in ("reward", "trial", "mark"):
            self._please(event.data)
        elif event.kind == "learn":
            self._ask(event.data)

    def _please(self, told: Mapping[str, Value]) -> None:
        """What was rewarded, or marked."""
        reward, group = told.get("reward"), told.get("group")
        if isinstance(reward, int | float):
            self._mind.rewards.give(float(reward), group if isinstance(group, str) else None)
        self._mind.rewards.marked(str(told.get("mark", "")))

    def _ask(self, told: Mapping[str, Value]) -> None:
        """What clients had learned, forgotten or begun anew."""
        if "added" in told:
            self._mind.add_gvf(told["added"])
        for verb, act in (("removed", self._mind.learners.remove), ("reset", self._mind.learners.reset)):
            names = told.get(verb)
            if isinstance(names, list):
                act([str(name) for name in names])


def _state(frame: Frame) -> State:
    """What the tick read, as far as the frame tells."""
    joints = tuple(
        JointState(
            joint.position,
            joint.velocity,
            joint.load,
            joint.voltage,
            joint.temperature,
            joint.age,
            joint.freshness,
            joint.errors,
            joint.stop,
        )
        for joint in frame.joints
    )
    return State(frame.read_at, joints)


def same_thoughts(one: Frame, other: Frame) -> bool:
    """Whether two frames hold the same predictions and the same wishes of the assist, bit for bit."""
    helped = (one.assist, one.more_assists) == (other.assist, other.more_assists)
    return (
        helped
        and one.learn.predictions == other.learn.predictions
        and all(
            mine.predictions == theirs.predictions and mine.asked.get("assist") == theirs.asked.get("assist")
            for mine, theirs in zip(one.joints, other.joints, strict=True)
        )
    )
