"""Where orders are carried out, so that no tick waits for them: a process that is started for each."""

import asyncio
import json
import sys
from typing import cast

from bentod.emg.live.orders import Order, written
from bentod.errors import Refused
from bentod.frames import Value

WORKER = "bentod.emg.live.worker"

PATIENCE_S = 600.0
"""s that an order may take."""


async def in_a_process(order: Order) -> dict[str, Value]:
    """Carry out `order` in a process of its own, which ends with whoever waits for it.

    Raises:
        Refused: it could not be, or took longer than `PATIENCE_S`.
    """
    pipe = asyncio.subprocess.PIPE
    try:
        process = await asyncio.create_subprocess_exec(
            sys.executable, "-P", "-m", WORKER, stdin=pipe, stdout=pipe, stderr=pipe
        )
    except OSError as error:
        raise Refused(f"no process can be started for this: {error.strerror or error}") from error
    try:
        async with asyncio.timeout(PATIENCE_S):
            out, err = await process.communicate(written(order))
    except TimeoutError as error:
        raise Refused(f"this took longer than {PATIENCE_S:.0f} s and was given up") from error
    finally:
        if process.returncode is None:
            process.kill()
            await asyncio.shield(process.wait())
    return _understood(out, err, process.returncode)


def _understood(out: bytes, err: bytes, code: int | None) -> dict[str, Value]:
    try:
        told = json.loads(out)
        failed, result = told.get("error"), told.get("result")
    except (ValueError, AttributeError) as error:
        last = err.decode(errors="replace").strip().rpartition("\n")[2]
        raise Refused(f"the process that trains ended with {code}: {last or 'it said nothing'}") from error
    if failed:
        raise Refused(str(failed["message"]))
    return cast("dict[str, Value]", result)
