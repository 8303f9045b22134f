"""Events that can be heard, and the short words by which a config says what each sounds like."""

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from bentod.errors import nearest

DEFAULTS: Mapping[str, str] = {
    "joint": "say:{}",
    "together": "say:all together",
    "pause": "say:paused",
    "release": "say:released",
    "limp": "say:limp",
    "stop": "tone:330/200 + say:stopped",
    "fault": "tone:880/120 + tone:440/120 + tone:880/120 + say:fault",
    "home.done": "say:home",
    "home.cancelled": "say:home cancelled",
    "trial.start": "tone:660/120",
    "trial.stop": "tone:660/120 + tone:440/120",
    "mark": "none",
    "mark.contact": "tone:165/120",
    "mark.waypoint": "tone:990/80",
    "mark.waypoint_held": "tone:1320/200",
    "mark.waypoint_left": "none",
    "mark.circuit": "tone:990/100 + tone:1320/100 + tone:1760/200",
    "emg.lost": "tone:440/120 + say:no muscle signal",
    "emg.prompt": "say:{}",
    "assist.offers_together": "tone:523/80 + tone:659/80 + tone:784/120",
}
"""What is heard when the config says nothing else; its keys are the events that there are."""

NAMED = ("joint", "mark", "emg.prompt")
"""Events that are about something with a name: `joint.elbow_flexion` is one of `joint`, as all others are."""

MOST_TEXT = 80
"""Characters of one sound as it is written."""

LOWEST_HZ, HIGHEST_HZ = 50, 4000
SHORTEST_MS, LONGEST_MS = 20, 2000

_NAME = re.compile(r"[^\W_](?:\w{0,62}[^\W_])?")
_PARTS = re.compile(r"\s*\+\s*(?=(?:say|tone|file):)")
_TONE = re.compile(r"(\d{1,5}(?:\.\d{1,3})?)/(\d{1,5})")
_FILE = re.compile(r"\w[\w. -]{0,59}\.wav", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Say:
    """Words to be spoken; `{}` in them is the name that the event is about."""

    text: str


@dataclass(frozen=True, slots=True)
class Tone:
    """A sine."""

    pitch: float  # Hz
    seconds: float


@dataclass(frozen=True, slots=True)
class File:
    """A WAV of the user's."""

    name: str


Part: TypeAlias = Say | Tone | File


def parse_sound(text: str) -> tuple[Part, ...]:
    """The parts of a sound, to be heard one after another: "say:TEXT", "tone:HZ/MS", "file:NAME.wav", "none".

    Raises:
        ValueError: it is not of that form, or a tone is out of bounds.
    """
    if not text.isprintable() or not 0 < len(text) <= MOST_TEXT:
        raise ValueError(f"must be 1 to {MOST_TEXT} characters that can be printed")
    if text == "none":
        return ()
    return tuple(_part(piece) for piece in _PARTS.split(text.strip()))


def _part(text: str) -> Part:
    kind, _, rest = text.partition(":")
    match kind:
        case "say" if rest.strip():
            return Say(" ".join(rest.split()))
        case "say":
            raise ValueError("'say:' needs words")
        case "file" if _FILE.fullmatch(rest):
            return File(rest)
        case "file":
            raise ValueError(f"'{rest}' is not the bare name of a .wav file")
        case "tone":
            return _tone(rest)
    hint = nearest(kind, ("say", "tone", "file", "none"))
    raise ValueError(f"'{text}' is none of say:TEXT, tone:HZ/MS, file:NAME.wav, none{hint}")


def _tone(text: str) -> Tone:
    found = _TONE.fullmatch(text)
    if not found:
        raise ValueError(f"'tone:{text}' must be tone:HZ/MS, e.g. tone:440/200")
    pitch, length = float(found[1]), int(found[2])
    if not LOWEST_HZ <= pitch <= HIGHEST_HZ:
        raise ValueError(f"tone of {pitch:g} Hz: must be {LOWEST_HZ} to {HIGHEST_HZ} Hz")
    if not SHORTEST_MS <= length <= LONGEST_MS:
        raise ValueError(f"tone of {length} ms: must be {SHORTEST_MS} to {LONGEST_MS} ms")
    return Tone(pitch, length / 1e3)


def event_problem(event: str) -> str:
    """Why there is no such event, as the end of a sentence; empty if there is."""
    base, name = split(event)
    if event in DEFAULTS or (base in NAMED and _NAME.fullmatch(name)):
        return ""
    known = [*DEFAULTS, *(f"{base}.NAME" for base in NAMED)]
    return f"there is no such event{nearest(event, known)}"


def split(event: str) -> tuple[str, str]:
    """An event as what happened, and the name of what it is about, if it has one."""
    for base in NAMED:
        if event.startswith(f"{base}."):
            return base, event[len(base) + 1 :]
    return event, ""


def named(base: str, text: str) -> str:
    """The event `base` about what `text` says, whatever characters that holds."""
    name = re.sub(r"[\W_]+", "_", text.casefold()).strip("_")[:64].strip("_")
    return f"{base}.{name}" if name else base


def candidates(event: str) -> tuple[str, ...]:
    """Keys of the table that may say how an event sounds, the most special first.

    `mark.waypoint_2_held`, then `mark.waypoint_held`, `mark.waypoint_2`, `mark.waypoint`, `mark`. A joint is
    either itself or any joint: a wrist is not a wrist_rotation.
    """
    base, name = split(event)
    if base == "joint" or not name:
        return tuple(dict.fromkeys((event, base)))
    words = name.split("_")
    found: list[str] = []
    for count in range(len(words), 0, -1):
        beginning = words[:count]
        found += ["_".join(beginning), "_".join(word for word in beginning if not word.isdecimal())]
    return tuple(dict.fromkeys((*(f"{base}.{key}" for key in found if key), base)))


def all_events(joints: Iterable[str], sounds: Mapping[str, str]) -> list[str]:
    """Every event whose sound can be told beforehand, in the order of the table; `joints`: their names."""
    events = [f"joint.{joint}" for joint in joints]
    events += [event for event in DEFAULTS if event != "joint"]
    return list(dict.fromkeys([*events, *(event for event in sounds if event != "joint")]))
