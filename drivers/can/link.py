"""What a CAN driver needs of a bus: classic frames with 11-bit identifiers, both ways, without waiting."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol


@dataclass(frozen=True, slots=True)
class Frame:
    """A classic CAN frame with a standard identifier."""

    id: int  # 11 bits
    data: bytes = b""  # at most 8
    remote: bool = False  # asks for the frame of this identifier; carries no data


class CanLink(Protocol):
    """A bus that carries frames both ways and never blocks.

    A CAN controller repeats a frame until somebody acknowledges it, so what was sent arrives, unless the
    bus is gone. Some software buses return what was sent to the sender, too.
    """

    def listen(self, on_frame: Callable[[Frame], None], on_trouble: Callable[[str], None]) -> None:
        """Call `on_frame` with what arrives, and `on_trouble` with a sentence when receiving fails.

        Both on the event loop. Frames may come again after trouble.
        """
        ...

    def send(self, frame: Frame) -> None:
        """Hand `frame` to the bus.

        Raises:
            BusError: it cannot take it now, e.g. its buffer is full because nobody acknowledges.
        """
        ...
