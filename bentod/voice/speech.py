"""Words as sound: espeak-ng speaks each text once, and what it said is kept."""

import hashlib
import logging
import shutil
import subprocess
from collections.abc import Mapping
from pathlib import Path

from bentod.errors import BentodError
from bentod.voice.tones import BadWav, Sound, from_wav, to_wav
from bentod.whole_file import replacing

_log = logging.getLogger(__name__)

PATIENCE = 5.0
"""s for one text; it takes 30 ms."""

LONGEST = 4.0
"""s of one text that are heard."""

KEPT = 500
"""Texts in the cache; the one that was made longest ago goes first."""

_DIGEST = hashlib.sha256().digest_size


class Mute(BentodError):
    """A text cannot be spoken.

    Examples: espeak-ng is not installed, it has no such voice, it did not answer in time.
    """

    code = "mute"


def cache_folder(environment: Mapping[str, str]) -> Path:
    """Where spoken texts are kept: as systemd says, else in $XDG_CACHE_HOME, else in ~/.cache."""
    if service := environment.get("CACHE_DIRECTORY"):
        return Path(service.split(":")[0], "voice")
    user = environment.get("XDG_CACHE_HOME")
    return (Path(user) if user else Path(environment.get("HOME", "/nonexistent"), ".cache")) / "bentod/voice"


class Speech:
    """One voice at one speed. `speak` blocks, and so belongs into a thread."""

    def __init__(self, voice: str, speed: int, folder: Path) -> None:
        """`speed`: words per minute; `folder`: the cache, made when it is needed."""
        self._voice, self._speed, self._folder = voice, speed, folder
        self._failed: dict[str, str] = {}  # why, by text: what failed is not tried again
        self._said: set[str] = set()

    def speak(self, text: str) -> Sound:
        """The text, spoken.

        Raises:
            Mute: it cannot be.
        """
        path = self._folder / f"{_key(self._voice, self._speed, text)}.wav"
        kept = _read(path)
        if kept is not None:
            return kept
        if text in self._failed:
            raise Mute(self._failed[text])
        try:
            sound = self._synthesised(text)
        except Mute as error:
            self._failed[text] = str(error)
            self._warn(f"{error} Tones stand in for words.")
            raise
        self._keep(path, to_wav(sound))
        return sound

    def _synthesised(self, text: str) -> Sound:
        program = shutil.which("espeak-ng")
        if program is None:
            raise Mute("espeak-ng is not installed.")
        # The text goes in by stdin: nothing in it can be an option, and no shell ever sees it.
        command = [program, "-b", "1", "-v", self._voice, "-s", str(self._speed), "--stdin", "--stdout"]
        try:
            done = subprocess.run(  # noqa: S603 - no shell, and the voice cannot begin with a dash
                command, input=text.encode(), capture_output=True, timeout=PATIENCE, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise Mute(f"espeak-ng did not speak within {PATIENCE:g} s.") from error
        except OSError as error:
            raise Mute(f"espeak-ng cannot be run: {error.strerror}.") from error
        try:
            return from_wav(done.stdout, LONGEST)
        except BadWav as error:  # it ends with 0 even when it has no such voice
            why = done.stderr.decode(errors="replace").strip().partition("\n")[0] or str(error)
            raise Mute(f"espeak-ng cannot speak with the voice {self._voice}: {why.rstrip('.')}.") from error

    def _keep(self, path: Path, wav: bytes) -> None:
        try:
            self._folder.mkdir(parents=True, exist_ok=True)
            with replacing(path) as file:
                file.write(wav + hashlib.sha256(wav).digest())
            _thin(self._folder)
        except OSError as error:
            self._warn(f"{self._folder} does not take what was spoken: {error.strerror}.")

    def _warn(self, sentence: str) -> None:
        """Log, but the same only once."""
        if sentence not in self._said:
            self._said.add(sentence)
            _log.warning("%s", sentence)


def _key(voice: str, speed: int, text: str) -> str:
    return hashlib.sha256("\0".join((voice, str(speed), text)).encode()).hexdigest()[:40]


def _read(path: Path) -> Sound | None:
    """What is kept there, if it is whole; the digest at its end says so."""
    try:
        data = path.read_bytes()
    except OSError:
        return None
    wav, digest = data[:-_DIGEST], data[-_DIGEST:]
    if hashlib.sha256(wav).digest() != digest:
        return None
    try:
        return from_wav(wav, LONGEST)
    except BadWav:
        return None


def _thin(folder: Path) -> None:
    """Raises OSError: the folder cannot be read."""
    found = sorted(folder.glob("*.wav"), key=lambda path: path.stat().st_mtime)
    for path in found[: max(0, len(found) - KEPT)]:
        path.unlink(missing_ok=True)
