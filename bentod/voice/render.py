"""Events as WAV: as the config says, the user's own files before all else, tones where words fail."""

import hashlib
import logging
import os
import threading
import zlib
from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from bentod.config_sounds import DEFAULTS, File, Part, Say, Tone, all_events, candidates, parse_sound, split
from bentod.config_voice import Voice
from bentod.voice.speech import Mute, Speech, cache_folder
from bentod.voice.tones import NOTES, BadWav, Sound, from_wav, joined, note, to_wav, tone

_log = logging.getLogger(__name__)

GAP = 0.04
"""s between two parts of a sound."""

LONGEST = 4.5
"""s of one sound; the page takes 200 kB."""

IN_MEMORY = 256

STAND_IN = 0.25
"""s of the tone that stands in for words."""

LOUDNESS = 0.5
"""Share of full scale of a tone at volume 1: words reach it in their peaks, and a tone is all peaks."""


class Renderer:
    """What each event sounds like on an arm of these joints. Blocks, and may be called from any thread."""

    def __init__(
        self, table: Voice, joints: Sequence[str], environment: Mapping[str, str] = os.environ
    ) -> None:
        """`joints`: names, in the order of the arm, which gives each its pitch."""
        self._table, self._joints = table, tuple(joints)
        self._speech = Speech(table.voice, table.speed, cache_folder(environment))
        self._folder = table.folder.expanduser() if table.folder else None
        self._ready: OrderedDict[str, bytes | None] = OrderedDict()
        self._lock = threading.Lock()  # no text is spoken twice because two asked at once
        self._said: set[str] = set()

    def events(self) -> list[str]:
        """Every event whose sound is known beforehand."""
        return all_events(self._joints, self._table.sounds)

    def words(self, event: str) -> str:
        """How the event sounds, as a config would say it."""
        for key in candidates(event):
            if self._own(f"{key}.wav"):
                return f"file:{key}.wav"
            for table in (self._table.sounds, DEFAULTS):
                if key in table:
                    return table[key]
        return "none"

    def wav(self, events: Iterable[str]) -> bytes | None:
        """The events one after another as a WAV file; None: nothing is to be heard."""
        key = " ".join(events)
        with self._lock:
            if key not in self._ready:
                self._ready[key] = self._rendered(key.split(" "))
                if len(self._ready) > IN_MEMORY:
                    self._ready.popitem(last=False)
            self._ready.move_to_end(key)
            return self._ready[key]

    def pitches(self) -> dict[str, float]:
        """Hz of the quiet cue, by what is selected."""
        return {name: note(index) for index, name in enumerate((*self._joints, "together"))}

    def _rendered(self, events: Sequence[str]) -> bytes | None:
        parts = [self._part(part, event) for event in events for part in parse_sound(self.words(event))]
        return to_wav(self._table.volume * joined(parts, GAP, LONGEST)) if parts else None

    def _part(self, part: Part, event: str) -> Sound:
        match part:
            case Tone():
                return LOUDNESS * tone(part.pitch, part.seconds)
            case File():
                return self._file(part.name, event)
            case Say():
                return self._spoken(part.text, event)

    def _spoken(self, text: str, event: str) -> Sound:
        base, name = split(event)
        spoken = text.replace("{}", (name or base.rpartition(".")[2]).replace("_", " "))
        try:
            return self._speech.speak(spoken)
        except Mute:
            return LOUDNESS * tone(self._stand_in(event), STAND_IN)

    def _file(self, name: str, event: str) -> Sound:
        path = self._own(name)
        try:
            if path is None:
                raise BadWav("there is no such file")
            return from_wav(path.read_bytes(), LONGEST)
        except (BadWav, OSError) as error:
            self._warn(f"{name} in {self._folder} cannot be played: {error}. A tone stands in for it.")
            return LOUDNESS * tone(self._stand_in(event), STAND_IN)

    def _stand_in(self, event: str) -> float:
        """Hz: joints differ from one another, and other events do as a rule."""
        base, name = split(event)
        if base == "joint" and name in self._joints:
            return note(self._joints.index(name))
        return note(zlib.crc32(event.encode()) % NOTES)

    def _own(self, name: str) -> Path | None:
        """The user's file of that name, if there is one."""
        path = self._folder / name if self._folder else None
        return path if path and path.is_file() else None

    def _warn(self, sentence: str) -> None:
        if sentence not in self._said:
            self._said.add(sentence)
            _log.warning("%s", sentence)


def identity(wav: bytes) -> str:
    """A name for these bytes and no others."""
    return hashlib.sha256(wav).hexdigest()[:32]
