"""The programs that play sound, and how each is asked to: a file, or samples that go on and on."""

import shutil
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Command:
    """One way to play what comes by standard input."""

    name: str
    file: tuple[str, ...]  # arguments for a WAV; empty: not for files
    stream: tuple[str, ...]  # arguments for raw samples, mono, 16 bits; {} is their rate (Hz)

    def to_play(self) -> tuple[str, ...]:
        """The words that play a WAV."""
        return (self.name, *self.file)

    def to_stream(self, rate_hz: int) -> tuple[str, ...]:
        """The words that play samples."""
        return (self.name, *(word.replace("{}", str(rate_hz)) for word in self.stream))


_PIPEWIRE = ("--playback", "--rate={}", "--channels=1", "--format=s16", "--latency=50ms")

# By name, not "-": libsndfile then opens the file anew and may seek in it, which a pipe would not let it.
_STDIN = ("/dev/stdin",)

COMMANDS = (
    Command("pw-play", _STDIN, ()),
    Command("pw-cat", (), (*_PIPEWIRE, "--raw", "-")),
    Command("pw-cat", (), (*_PIPEWIRE, "-")),  # before --raw was there, "-" alone meant the same
    Command("paplay", _STDIN, ("--raw", "--rate={}", "--channels=1", "--format=s16le", "--latency-msec=50")),
    Command(
        "aplay", ("-q", *_STDIN), ("-q", "-t", "raw", "-f", "S16_LE", "-c", "1", "-r", "{}", "-B", "100000")
    ),
)
"""In the order in which they are tried: what mixes with other programs' sound before what may block them."""


def installed() -> tuple[Command, ...]:
    """Those of `COMMANDS` that are on the path."""
    return tuple(command for command in COMMANDS if shutil.which(command.name))
