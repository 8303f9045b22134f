"""A process that asks something of a daemon, so many times a second, until it is ended."""

import sys
import time
from pathlib import Path

from bentod.blocking import BlockingClient
from bentod.errors import BentodError

AGAIN = 0.05
"""s until it knocks again where nobody answers."""


def main(socket: Path, rate_hz: float) -> None:
    """Ask for ever; what is late is not made up for."""
    while True:
        try:
            with BlockingClient(socket) as arm:
                _ask(arm, 1 / rate_hz)
        except BentodError:
            time.sleep(AGAIN)


def _ask(arm: BlockingClient, period: float) -> None:
    due = time.monotonic()
    while True:
        arm.call("get_info")
        due = max(due + period, time.monotonic() - period)
        time.sleep(max(0.0, due - time.monotonic()))


if __name__ == "__main__":
    main(Path(sys.argv[1]), float(sys.argv[2]))
