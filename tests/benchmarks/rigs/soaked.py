"""A daemon as `bentod run` starts it, which also tells how many tasks it has: a line of JSON a second."""

import asyncio
import json
import sys
from pathlib import Path

import click

from bentod import logs
from bentod.cli.configs import read
from bentod.clock import SystemClock
from bentod.daemon import Daemon
from bentod.realtime import upkeep
from bentod.supervise import Supervisor

EVERY = 0.5  # s


async def tell() -> None:
    """Tasks of this loop, this one not counted."""
    while True:
        click.echo(json.dumps({"tasks": len(asyncio.all_tasks()) - 1}))
        await asyncio.sleep(EVERY)


async def main(config: Path, socket: Path) -> None:
    """Run until a signal comes."""
    checked = read(config)
    async with SystemClock() as clock:
        with upkeep(checked.realtime, clock) as around:
            teller = asyncio.create_task(tell())
            await Daemon(checked, clock, Supervisor(), socket, upkeep=around).run()
            teller.cancel()


if __name__ == "__main__":
    with logs.setup("ERROR"):
        asyncio.run(main(Path(sys.argv[1]), Path(sys.argv[2])))
