"""What only the optional extra `lsl` brings is loaded when it is asked for, or its name is told."""

from collections.abc import Callable
from typing import cast

from bentod.errors import BentodError, ConfigError
from bentod.lsl.stream import OpenOutlet
from bentod.registry import resolve


class MissingLsl(BentodError):
    """Something must be installed.

    Examples: pylsl is not there, or it finds no liblsl for this machine.
    """

    code = "extra"


def load() -> tuple[OpenOutlet, Callable[[], float]]:
    """How a stream is put on the network, and LSL's clock (s).

    Raises:
        MissingLsl: pylsl or its library cannot be loaded.
    """
    try:
        outlet = resolve("bentod.lsl.outlets:LslOutlet")
        clock = resolve("bentod.lsl.outlets:local_clock")
    except (ConfigError, RuntimeError) as error:  # the second is pylsl's, where it finds no library
        raise MissingLsl(
            "LSL streams need pylsl, which cannot be loaded; the extra 'lsl' brings it: "
            f"pip install 'bentod[lsl]' ({error})"
        ) from error
    return cast("OpenOutlet", outlet), cast("Callable[[], float]", clock)
