"""A port for the official SDK that keeps what is sent and hands out what is to be received."""

from collections.abc import Sequence


class SdkPort:
    """What the official SDK needs of a port."""

    def __init__(self, incoming: bytes = b"") -> None:
        self.is_using = False
        self.sent = b""
        self.incoming = list(incoming)

    def clearPort(self) -> None:  # noqa: N802
        pass

    def writePort(self, packet: Sequence[int]) -> int:  # noqa: N802
        self.sent = bytes(packet)
        return len(packet)

    def readPort(self, length: int) -> list[int]:  # noqa: N802
        taken, self.incoming = self.incoming[:length], self.incoming[length:]
        return taken

    def setPacketTimeout(self, length: int) -> None:  # noqa: N802
        pass

    def isPacketTimeout(self) -> bool:  # noqa: N802
        return True
