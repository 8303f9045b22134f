"""`bentod replay`: a recording played to clients as if it were live, or learned from again."""

import asyncio
import math
import time
from pathlib import Path

import click

from bentod.cli.changes import single
from bentod.cli.until_told import until_told
from bentod.clock import SystemClock
from bentod.config import Config
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError
from bentod.record.reader import Recording
from bentod.replay.altered import altered, relearner
from bentod.replay.comparison import Comparison, compared
from bentod.replay.player import Source, Span
from bentod.replay.relearn import Relearner, Thought, ticks
from bentod.replay.stage import Stage


class _Speed(click.ParamType[float]):
    name = "speed"

    def convert(self, value: object, param: click.Parameter | None, ctx: click.Context | None) -> float:
        if value == "max":
            return math.inf
        try:
            speed = float(str(value))
        except ValueError:
            speed = math.nan
        return speed if speed > 0 else self.fail(f"{value} is neither above 0 nor max", param, ctx)


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--speed", type=_Speed(), default="1", show_default=True, help="Times real time, or max.")
@click.option("--from", "start", type=click.FloatRange(min=0), default=0.0, help="s to begin at.")
@click.option("--loop", is_flag=True, help="Begin again at the end.")
@click.option("--stay", is_flag=True, help="Stay at the end until Ctrl-C.")
@click.option("--paused", is_flag=True, help="Wait for `replay_pause` off.")
@click.option("--socket", type=click.Path(path_type=Path), help="Socket path; default: the daemon's.")
@click.option("--learn", is_flag=True, help="Learn again, as fast as possible, and compare.")
@click.option("--serve", is_flag=True, help="With --learn: play what is learned this time.")
@click.option("--set", "changes", multiple=True, metavar="KEY=VALUE", help="For --learn: learn.step_size=0.1")
def replay(
    file: Path,
    speed: float,
    start: float,
    loop: bool,
    stay: bool,
    paused: bool,
    socket: Path | None,
    learn: bool,
    serve: bool,
    changes: tuple[str, ...],
) -> None:
    """Play the recording FILE: `bentod ctl`, `watch` and any client see what they would have seen live."""
    if (changes or serve) and not learn:
        raise click.UsageError("--set and --serve belong to --learn")
    try:
        with Recording(file) as recording:
            chosen = single(changes)
            config = altered(recording.header, chosen)
            if learn and not serve:
                _compare(recording, relearner(recording.header, chosen))
                return
            again = relearner(recording.header, chosen) if learn else None
            asyncio.run(_play(recording, config, socket, again, (speed, start, loop, stay, paused)))
    except BentodError as error:
        raise click.ClickException(str(error)) from error


def _compare(recording: Recording, relearner: Relearner) -> None:
    began = time.perf_counter()
    found = compared(ticks(recording.entries()), relearner)
    took = time.perf_counter() - began
    for line in lines(found):
        click.echo(line)
    if found.ticks:
        span = found.ticks / recording.header.rate_hz
        click.echo(f"{span:.1f} s of recording in {took:.1f} s: {span / took:.0f} times real time.")


def lines(found: Comparison) -> list[str]:
    """A comparison in words, and a table of errors."""
    told = [f"{found.equal} of {found.ticks} ticks were thought bit for bit as they were live."]
    if found.first_other >= 0:
        told.append(f"The first that was not is tick {found.first_other}.")
    if found.broken:
        told.append(f"{found.broken} ticks broke live; what they read is not recorded.")
    told.append(f"The assist was engaged in {found.engaged[0]} ticks live and in {found.engaged[1]} now.")
    if found.errors:
        told += ["", f"{'root mean square error, rad':32} {'steps':>6} {'live':>10} {'now':>10}"]
    told += [f"{e.joint:32} {e.timescale:>6} {e.live:10.4f} {e.again:10.4f}" for e in found.errors]
    if found.gvfs:
        told += ["", f"{'running error of other GVFs':39} {'live':>10} {'now':>10}"]
    return told + [f"{e.name:39} {e.live:10.4g} {e.again:10.4g}" for e in found.gvfs]


async def _play(
    recording: Recording,
    config: Config,
    socket: Path | None,
    relearner: Relearner | None,
    manner: tuple[float, float, bool, bool, bool],
) -> None:
    speed, start, loop, stay, paused = manner
    where = socket or default_socket_path()
    async with SystemClock() as clock:
        tape: Source = Thought(recording, relearner) if relearner else recording
        info = recording.info
        stage = Stage(tape, Span(info.start, info.end), config, clock, where)
        player = stage.player
        player.set_speed(speed)
        player.loop, player.stay = loop, stay
        player.pause(paused)
        if start:
            player.seek(start)
        async with stage.server:
            click.echo(f"Playing {recording.header.arm}, {player.duration:.1f} s, at {where}. Ctrl-C ends.")
            await until_told(player.run())
