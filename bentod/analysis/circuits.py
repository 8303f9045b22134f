"""Trials as the thesis counts them (5.5, appendix B): how long, how many toggles, how many contacts.

* A *circuit* is a trial, from the tick at which it starts to the tick at which it stops. Where an
  experimenter marks `circuit` in a trial, each mark ends one circuit and begins the next; what follows the
  last mark is not a whole circuit and is left out. So is all of a trial without one that says, by a mark
  `task`, that its circuits and contacts are marked.
* A *toggle* is a change of a group's active joint, by whomever, as the events of kind "group" tell.
* A *contact* is a mark `contact`, or one that begins so: bentod feels no contact itself. In a recording
  without any such mark, nor a mark `task`, nobody knows how many there were: the count is None, not 0.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bentod.analysis.setup import setup
from bentod.frames import Event, Value
from bentod.record.reader import Recording
from bentod.record.session import Info, TrialSpan

CIRCUIT, CONTACT, TASK = "circuit", "contact", "task"

BREAKS = ("paused", "unseen")
"""Marks that make a circuit's time mean less; it counts, and is remarked."""

PARTICIPANT = ("participant", "subject")
"""Keys of the metadata that name who wears the arm, the first that is there."""


@dataclass(frozen=True, slots=True)
class Circuit:
    """One circuit of one trial."""

    session: str
    participant: str  # the session's name, if the metadata names nobody
    timescale: float  # steps, of the predictions that the assist follows; 0: there is no assist
    condition: str
    trial: int
    name: str
    number: int  # of the circuit within its trial, from 1
    start: float  # monotonic s
    time: float  # s
    toggles: int
    contacts: int | None  # None: not recorded
    whole: bool  # it came to its end; others count for nothing
    remark: str  # what was out of the ordinary; empty if nothing was


@dataclass(frozen=True, slots=True)
class _Times:
    toggles: Sequence[float]
    contacts: Sequence[float] | None
    circuits: Sequence[float]
    tasks: Sequence[float]
    breaks: Sequence[tuple[float, str]]  # in which somebody was paused, or not seen
    faults: Sequence[float]


def circuits(recording: Recording) -> list[Circuit]:
    """Every circuit of a recording, in the order of time. Raises BentodError: it cannot be read."""
    header, info = recording.header, recording.info
    times = _times(list(recording.events()), _active_at_first(recording))
    timescale = setup(header.config).assist_timescale
    found = []
    for span in info.trials:
        for number, (start, end, whole) in enumerate(_parts(span, times), 1):
            contacts = None if times.contacts is None else _within(times.contacts, start, end)
            found.append(
                Circuit(
                    session=header.session,
                    participant=participant(info, start) or header.session,
                    timescale=timescale,
                    condition=span.trial.condition,
                    trial=span.trial.number,
                    name=span.trial.name,
                    number=number,
                    start=start,
                    time=end - start,
                    toggles=_within(times.toggles, start, end),
                    contacts=contacts,
                    whole=whole,
                    remark=_remark(info, times, start, end, whole),
                )
            )
    return found


def participant(info: Info, time: float) -> str:
    """Who wore the arm at `time` (monotonic s), by the metadata; empty if it names nobody."""
    meta: Value = None
    for since, told in info.metas:
        meta = told if since <= time or meta is None else meta
    named = meta if isinstance(meta, dict) else {}
    return next((str(named[key]) for key in PARTICIPANT if key in named), "")


def _active_at_first(recording: Recording) -> dict[str, str]:
    first = next(recording.frames(), None)
    return {group.name: group.active for group in first.groups} if first else {}


def _times(events: Sequence[Event], active: Mapping[str, str]) -> _Times:
    contacts = [event.time for event in events if mark(event).startswith(CONTACT)]
    tasks = [event.time for event in events if mark(event).split(" ")[0] == TASK]
    return _Times(
        toggles=[event.time for event in switches(events, active)],
        contacts=contacts if contacts or tasks else None,
        circuits=[event.time for event in events if mark(event) == CIRCUIT],
        tasks=tasks,
        breaks=[(event.time, mark(event)) for event in events if mark(event) in BREAKS],
        faults=[event.time for event in events if event.kind == "fault"],
    )


def mark(event: Event) -> str:
    """What an experimenter marked; empty if the event is no mark."""
    return str(event.data.get("mark", "")) if event.kind == "trial" else ""


def switches(events: Sequence[Event], at_first: Mapping[str, str]) -> Iterator[Event]:
    """The events that selected another joint, or all; `at_first`: the active joint by group, before them."""
    selected = {group: (joint, False) for group, joint in at_first.items()}
    for event in events:
        if event.kind == "group" and "active" in event.data:
            group, joint = str(event.data.get("group", "")), str(event.data["active"])
            now = joint, event.data.get("together") is True
            if selected.get(group) != now:
                yield event
            selected[group] = now


def _parts(span: TrialSpan, times: _Times) -> list[tuple[float, float, bool]]:
    """Start, end, and whether it is whole, of a trial's circuits."""
    start, end = span.start, span.end
    inside = [time for time in times.circuits if start < time <= end]
    if not inside:
        marked = any(start <= time <= end for time in times.tasks)
        return [(start, end, span.ended and not marked)]
    return list(zip([start, *inside[:-1]], inside, [True] * len(inside), strict=True))


def _within(times: Sequence[float], start: float, end: float) -> int:
    return sum(start <= time < end for time in times)


def _remark(info: Info, times: _Times, start: float, end: float, whole: bool) -> str:
    missing = sum(gap.missing for gap in info.tick_gaps if gap.start < end and gap.end > start)
    remarks = [
        "" if whole else "has no end, not counted",
        *dict.fromkeys(what for time, what in times.breaks if start <= time < end),
        "fault" if _within(times.faults, start, end) else "",
        f"{missing} ticks missing" if missing > 0 else "",
    ]
    return ", ".join(remark for remark in remarks if remark)
