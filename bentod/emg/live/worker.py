"""The process that aligns and trains: an order on its standard input, what came of it on its output."""

import json
import os
import sys
from contextlib import suppress

from bentod.emg.live.carrying_out import carried_out
from bentod.emg.live.orders import ORDER
from bentod.errors import BentodError

NICE = 15
"""So that whatever the arm needs comes first."""


def _stand_back() -> None:
    """Take only the time that nobody else wants, on any processor: the tick may be pinned to one."""
    with suppress(OSError):  # a supervisor may forbid it
        os.nice(NICE)
    with suppress(OSError, AttributeError):
        os.sched_setscheduler(0, os.SCHED_BATCH, os.sched_param(0))
    with suppress(OSError, AttributeError):
        os.sched_setaffinity(0, range(os.cpu_count() or 1))


def main() -> None:
    """Carry out one order. Whatever is wrong with it is told as data, too."""
    _stand_back()
    try:
        told = {"result": carried_out(ORDER.validate_json(sys.stdin.buffer.read()))}
    except (BentodError, OSError, ValueError, MemoryError) as error:
        told = {"error": {"message": str(error) or type(error).__name__}}
    json.dump(told, sys.stdout)


if __name__ == "__main__":
    main()
