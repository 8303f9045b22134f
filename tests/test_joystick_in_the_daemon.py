"""A whole daemon with a joystick, in virtual time: pushed, on the way home, unplugged on it."""

from collections.abc import AsyncIterator, Callable, Iterator, Mapping
from contextlib import asynccontextmanager
from pathlib import Path
from unittest import mock

import pytest

from bentod import registry
from bentod.client import Client
from bentod.config import Config
from bentod.config_file import parse
from bentod.config_tables import Record
from bentod.contracts import Clock
from bentod.frames import Value
from sim import joystick
from sim.joystick import SimPad
from tests.rig import CONFIGS, PLAIN, joint, number, quiet_config, running, state, table, tables, wait_for

HOLD, HOME = 5, 8


def config(*changes: tuple[str, str]) -> Config:
    """The shipped one, with a simulated pad."""
    text = (CONFIGS / "joystick.toml").read_text()
    for old, new in (PLAIN, ('name = "linux"', 'name = "sim"'), ('device = "/dev/input/js0"', ""), *changes):
        assert old in text, old
        text = text.replace(old, new)
    return parse(text, "joystick.toml", registry).model_copy(update={"record": Record(enabled=False)})


@pytest.fixture
def pads() -> Iterator[list[SimPad]]:
    """The simulated pads that a daemon opens, to be pushed by hand."""
    opened: list[SimPad] = []
    open_joystick = joystick.open_joystick

    @asynccontextmanager
    async def keep(options: Mapping[str, Value], clock: Clock) -> AsyncIterator[SimPad]:
        async with open_joystick(options, clock) as pad:
            opened.append(pad)
            yield pad

    with mock.patch.object(joystick, "open_joystick", keep):
        yield opened


async def pass_ticks(arm: Client, ticks: int) -> None:
    before = number(await state(arm), "tick")
    await wait_for(arm, lambda frame: number(frame, "tick") > before + ticks)


async def push(arm: Client, pad: SimPad, effort: float = 1.0) -> None:
    """Hold the dead man at rest, then push the arm's stick."""
    pad.push(0, 0.0)
    pad.press()
    await wait_for(arm, lambda frame: not table(frame["joystick"])["held"])
    pad.press(HOLD)
    await wait_for(arm, lambda frame: bool(table(frame["joystick"])["held"]))
    pad.push(0, effort)
    await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "velocity") > 0.1)


async def test_a_push_moves_the_arm_and_the_event_of_its_coming_is_told(
    tmp_path: Path, pads: list[SimPad]
) -> None:
    async with running(config(), tmp_path / "s") as arm:
        (pad,) = pads
        await push(arm, pad)
        frame = await state(arm)
        assert joint(frame, "shoulder_rotation")["holder"] == "joystick"
        assert tables(frame, "groups")[0]["operator"] == "joystick"
        async with arm.listen("events") as events:
            pad.unplug()
            event = await anext(events)
        assert (event["kind"], event["text"]) == ("joystick", "The simulated joystick is unplugged.")
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "velocity") == 0)


async def test_the_way_home_goes_on_only_while_the_dead_man_is_held(
    tmp_path: Path, pads: list[SimPad]
) -> None:
    async with running(config(), tmp_path / "s") as arm:
        (pad,) = pads
        await push(arm, pad)
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "position") > 0.5)
        pad.push(0, 0.0)
        ways: tuple[Callable[[], None], ...] = (pad.press, pad.unplug)
        for let_go in ways:
            pad.press(HOLD, HOME)
            await wait_for(arm, lambda frame: goal(frame) == "moving")
            pad.press(HOLD)
            await pass_ticks(arm, 10)
            assert goal(await state(arm)) == "moving"
            let_go()
            frame = await wait_for(arm, lambda frame: goal(frame) == "cancelled")
            assert table(frame["goal"])["reason"] == "the joystick let go of it"


def goal(frame: Mapping[str, Value]) -> str:
    found = frame["goal"]
    return str(found["status"]) if isinstance(found, dict) else ""


def hangs_still(frame: Mapping[str, Value]) -> bool:
    return all(abs(number(one, "velocity")) < 0.05 for one in tables(dict(frame), "joints"))


async def test_a_home_that_was_refused_does_not_begin_later(tmp_path: Path, pads: list[SimPad]) -> None:
    async with running(config(), tmp_path / "s") as arm:
        (pad,) = pads
        await push(arm, pad)
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "position") > 0.3)
        pad.push(0, 0.0)
        await arm.call("torque", on=False)
        pad.press(HOLD, HOME)
        await wait_for(arm, lambda frame: frame["mode"] == "limp")
        await pass_ticks(arm, 5)
        await wait_for(arm, hangs_still)
        await arm.call("torque", on=True)
        await pass_ticks(arm, 5)
        assert goal(await state(arm)) == ""


async def test_clients_are_told_what_axes_and_buttons_do(tmp_path: Path, pads: list[SimPad]) -> None:
    async with running(config(), tmp_path / "s") as arm:
        told = table(await arm.call("joystick_get"))
        assert (told["source"], told["dead_man"], told["connected"]) == ("sim", HOLD, True)
        first = tables(told, "axes")[0]
        assert (first["axis"], first["group"], first["joint"], first["dead_zone"]) == (0, "arm", None, 0.15)
        assert tables(told, "buttons")[0]["action"] == "toggle"


async def test_without_such_a_table_there_is_nothing_to_tell(tmp_path: Path) -> None:
    async with running(quiet_config(PLAIN), tmp_path / "s") as arm:
        assert await arm.call("joystick_get") is None
        assert (await state(arm))["joystick"] is None


async def test_a_program_pushes_by_itself(tmp_path: Path, pads: list[SimPad]) -> None:
    program = (
        "program = [{ seconds = 0.2 }, { seconds = 0.2, buttons = [5] }, "
        "{ seconds = 1.0, buttons = [5], axes = { 0 = 1.0 } }]"
    )
    pushed = config(('name = "sim"              #', f'name = "sim"\n{program} #'))
    async with running(pushed, tmp_path / "s") as arm:
        await wait_for(arm, lambda frame: number(joint(frame, "shoulder_rotation"), "position") > 0.3)
