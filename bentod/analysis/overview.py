"""A recording at a glance: what it is, what it holds, what is missing, and what happened."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields

from bentod.analysis.columns import as_json
from bentod.frames import Event
from bentod.record.reader import Recording
from bentod.record.session import Counts, Header, Info

IMPORTANT = ("fault", "servo", "recording")
"""Kinds of events that are told one by one; the others are counted."""

MOST = 20
"""Events, gaps and trials of one kind that are told one by one."""

KINDS: Mapping[str, str] = {
    "frames": "ticks",
    "emg": "EMG blocks",
    "events": "events",
    "commands": "client commands",
}
"""What the entries are called, by the names of `Counts`."""


@dataclass(frozen=True, slots=True)
class Overview:
    """What `info` shows."""

    header: Header
    info: Info
    events: Mapping[str, int]  # how many, by kind
    important: tuple[Event, ...]


def overview(recording: Recording) -> Overview:
    """A recording at a glance. Raises BentodError: it cannot be read."""
    counts: dict[str, int] = {}
    important = []
    for event in recording.events():
        counts[event.kind] = counts.get(event.kind, 0) + 1
        if event.kind in IMPORTANT:
            important.append(event)
    return Overview(recording.header, recording.info, counts, tuple(important))


def sentences(found: Overview) -> list[str]:
    """The overview as lines of text."""
    header, info = found.header, found.info
    return [
        f"{header.session}: {header.arm}, {header.rate_hz:g} Hz, {len(header.joints)} joints "
        f"({', '.join(spec.name for spec in header.joints)})",
        f"  began    {wall_time(header.started_wall)}, lasted {duration(info.duration)}",
        f"  files    {len(info.files)}, {info.bytes / 1e6:.1f} MB{_rate(info)}",
        f"  holds    {_counts(info)}",
        f"  state    {state(info)}",
        *(f"  missing  {line}" for line in missing(info)),
        *_trials(found),
        *_metas(found),
        *_events(found),
        f"  made by  {', '.join(f'{name} {version}' for name, version in header.versions.items())}",
        f"  config   {header.config_name or '(no name)'}, schema {header.schema}",
    ]


def state(info: Info) -> str:
    """Whether the recording is over, and came to its end as it should."""
    if info.live:
        return "is being recorded"
    return "complete" if info.complete else "not complete: it was cut off, or a part is absent"


def missing(info: Info) -> list[str]:
    """What is not there, in sentences; one that says so when nothing is known to be missing."""
    dropped = ", ".join(
        f"{getattr(info.dropped, field.name)} {KINDS.get(field.name, field.name)}"
        for field in fields(Counts)
        if getattr(info.dropped, field.name)
    )
    found = [
        *info.problems,
        f"{info.ticks_missing} ticks that were made" if info.ticks_missing else "",
        f"{info.ticks_skipped} ticks that the daemon itself was too late for" if info.ticks_skipped else "",
        f"{info.samples_missing} of {info.samples + info.samples_missing} EMG samples"
        if info.samples_missing
        else "",
        f"{dropped}, which the recorder could not write" if dropped else "",
    ]
    return [line for line in found if line] or [
        "nothing that is known: every tick, sample and entry is there"
    ]


def _rate(info: Info) -> str:
    return f", {info.bytes / 1e6 / info.duration * 3600:.0f} MB/h" if info.duration > 0 else ""


def _counts(info: Info) -> str:
    told = [
        f"{getattr(info.counts, name)} {label}" + _per_second(getattr(info.counts, name), info)
        for name, label in KINDS.items()
    ]
    return ", ".join([*told, f"{info.samples} EMG samples" + _per_second(info.samples, info)])


def _per_second(count: int, info: Info) -> str:
    return f" ({count / info.duration:.3g}/s)" if count and info.duration > 0 else ""


def _trials(found: Overview) -> list[str]:
    spans = found.info.trials
    lines = [
        f"  trial    {span.trial.number} {span.trial.name or '(no name)'}, "
        f"{span.trial.condition or '(no condition)'}: at {_at(found, span.start)}, "
        f"{span.end - span.start:.1f} s{'' if span.ended else ', has no end'}"
        for span in spans[:MOST]
    ]
    return _cut(lines, len(spans), "trial    ") or ["  trials   none"]


def _metas(found: Overview) -> list[str]:
    told = [(at, meta) for at, meta in found.info.metas if meta is not None]
    lines = [f"  meta     at {_at(found, at)}: {as_json(meta)}" for at, meta in told[:MOST]]
    return _cut(lines, len(told), "meta     ")


def _events(found: Overview) -> list[str]:
    lines = [
        f"  {event.kind:<8} at {_at(found, event.time)}: {event.text}" for event in found.important[:MOST]
    ]
    others = ", ".join(f"{count} {kind}" for kind, count in sorted(found.events.items()))
    return [*_cut(lines, len(found.important), "         "), f"  events   {others or 'none'}"]


def _cut(lines: list[str], total: int, label: str) -> list[str]:
    return [*lines, f"  {label}… and {total - len(lines)} more"] if total > len(lines) else lines


def _at(found: Overview, moment: float) -> str:
    return f"{moment - found.header.started:.1f} s"


def wall_time(seconds: float) -> str:
    """A wall time in UTC."""
    return time.strftime("%Y-%m-%d %H:%M:%S UTC", time.gmtime(seconds))


def duration(seconds: float) -> str:
    """Hours, minutes and seconds."""
    minutes, rest = divmod(round(seconds, 1), 60)
    hours, minutes = divmod(int(minutes), 60)
    if hours:
        return f"{hours} h {minutes:02d} min {rest:04.1f} s"
    return f"{minutes} min {rest:04.1f} s" if minutes else f"{rest:.1f} s"


def as_data(found: Overview) -> dict[str, object]:
    """The overview as plain data, for JSON; the config's text and the robot's description are left out."""
    header, info = asdict(found.header), asdict(found.info)
    for long in ("config", "urdf", "joints"):
        header.pop(long, None)
    return {
        "header": header | {"joints": [spec.name for spec in found.header.joints]},
        "info": info | {"duration": found.info.duration, "whole": found.info.whole},
        "events": dict(found.events),
        "important": [asdict(event) for event in found.important],
    }


def completeness(info: Info) -> Sequence[tuple[str, ...]]:
    """Rows of what was made, what is there and what is missing, as texts."""
    made = info.counts.frames + info.ticks_missing
    samples = info.samples + info.samples_missing
    return [
        ("ticks", str(made), str(info.counts.frames), str(info.ticks_missing), str(info.dropped.frames)),
        ("EMG samples", str(samples), str(info.samples), str(info.samples_missing), "–"),
        ("EMG blocks", "–", str(info.counts.emg), "–", str(info.dropped.emg)),
        ("events", "–", str(info.counts.events), "–", str(info.dropped.events)),
        ("client commands", "–", str(info.counts.commands), "–", str(info.dropped.commands)),
    ]


COMPLETENESS_HEAD = ("what", "made", "in the recording", "missing", "not written by the recorder")
