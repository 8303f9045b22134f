"""Errors that say who must act: the person at the config, at the cable, or at the arm."""

import difflib
from collections.abc import Iterable


def nearest(name: str, known: Iterable[str]) -> str:
    """The end of a sentence about an unknown name: what may have been meant, or what there is."""
    names = sorted(known)
    close = difflib.get_close_matches(name[:64], names, n=1, cutoff=0.5)
    if close:
        return f"; did you mean '{close[0]}'?"
    return f" (known: {', '.join(names)})" if names else ""


class BentodError(Exception):
    """Base of every error that bentod raises on purpose; the text is a sentence for a person."""

    code = "error"
    """Short name of the kind of error, as socket clients see it."""

    def __init__(self, message: str, field: str = "") -> None:
        super().__init__(message)
        self.field = field
        """Name of the parameter or config key at fault; empty when there is none."""


class ConfigError(BentodError):
    """The config file must be edited.

    Examples: an unknown key, a limit outside its bound, a joint in a group that does not exist.
    """

    code = "config"


class BusError(BentodError):
    """A cable or a servo needs attention.

    Examples: the port cannot be opened, servo 3 does not answer a ping, the wrong model answers.
    """

    code = "bus"


class InputFileError(BentodError):
    """A source of muscle signals cannot be opened or read.

    Examples: the recording does not exist, it has no array of samples, it has too few channels.
    """

    code = "input"


class RecordingError(BentodError):
    """A recording cannot be read or repaired.

    Examples: the file is no recording, it is of a newer version, it is still being recorded.
    """

    code = "recording"


class SnapshotError(BentodError):
    """What was learned in an earlier session cannot be used.

    Examples: the file is cut off, a byte in it has changed, it is of a newer version.
    """

    code = "snapshot"


class Refused(BentodError):
    """The request is well formed, but the arm may not do it now; the text says what to do first.

    Examples: a move while the arm is paused, torque on while a fault is latched.
    """

    code = "refused"


class BadRequest(BentodError):
    """A client must mend its request.

    Examples: an unknown method, a missing parameter, a velocity beyond the joint's maximum.
    """

    code = "bad_request"
