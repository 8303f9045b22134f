"""The latency timer of a USB adapter: how long it sits on a short reply before it passes it on."""

from pathlib import Path

ADAPTERS = Path("/sys/bus/usb-serial/devices")

BEST = 1
"""ms. The default is 16, which every short reply waits for (DynamixelSDK#288, #316, #319, #330)."""


class LatencyTimer:
    """Of one port; ports without one (a pseudo-terminal, an adapter of another kind) have nothing to read."""

    def __init__(self, port: str, adapters: Path = ADAPTERS) -> None:
        """`port` may be a link, as those under /dev/serial/by-id are."""
        self.path = adapters / Path(port).resolve().name / "latency_timer"

    def read(self) -> int | None:
        """Ms; None when there is none."""
        try:
            return int(self.path.read_text(encoding="ascii"))
        except (OSError, ValueError):
            return None

    def set_best(self) -> bool:
        """Whether it is at its best now; it is not when access is denied."""
        try:
            self.path.write_text(f"{BEST}\n", encoding="ascii")
        except OSError:
            return False
        return self.read() == BEST
