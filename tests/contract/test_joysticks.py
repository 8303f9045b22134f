"""What every joystick must keep, whoever reads it."""

import asyncio
import importlib.util
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from bentod.contracts import JoystickSource
from drivers.joystick import linux, sdl
from tests.drivers.joystick.rigs import AXES, BUTTONS, RIGS, Opened, Rig, until

pytestmark = pytest.mark.real_time  # a kernel's pipe and SDL's thread take part

NO_SDL = pytest.mark.skipif(importlib.util.find_spec("pygame") is None, reason="pygame-ce is not installed")


@pytest.fixture(params=[pytest.param(name, marks=NO_SDL if name == "sdl" else ()) for name in sorted(RIGS)])
async def opened(
    request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> AsyncIterator[Opened]:
    """A source with a pad that is plugged in, and hands on it."""
    monkeypatch.setattr(linux, "RETRY_S", 0.01)
    monkeypatch.setattr(sdl, "RETRY_S", 0.01)
    async with RIGS[request.param](tmp_path) as both:
        await until(both[0], lambda pad: pad.connected and len(pad.buttons) == BUTTONS)
        yield both


@pytest.fixture
def source(opened: Opened) -> JoystickSource:
    return opened[0]


@pytest.fixture
def rig(opened: Opened) -> Rig:
    return opened[1]


async def test_a_pad_that_nobody_touches_is_there_at_rest_and_alive(source: JoystickSource) -> None:
    pad = source.latest()
    assert (pad.axes, pad.buttons, pad.presses) == ((0.0,) * AXES, (False,) * BUTTONS, (0,) * BUTTONS)
    assert (pad.reason, pad.openings) == ("", 1)
    await asyncio.sleep(0.03)
    later = source.latest()
    assert later.seen > pad.seen
    assert later.changed == pytest.approx(pad.changed, abs=1e-3)


async def test_an_axis_goes_from_minus_one_to_one(source: JoystickSource, rig: Rig) -> None:
    rig.push(1, 1.0)
    pushed = await until(source, lambda pad: pad.axes[1] > 0.5)
    rig.push(1, -1.0)
    pulled = await until(source, lambda pad: pad.axes[1] < -0.5)
    assert pushed.axes[1] == pytest.approx(1, abs=1e-3)
    assert pulled.axes[1] == pytest.approx(-1, abs=1e-3)
    assert pulled.changed >= pushed.changed > 0


async def test_every_press_is_counted_be_it_shorter_than_a_look(source: JoystickSource, rig: Rig) -> None:
    rig.press(4)
    await until(source, lambda pad: pad.buttons[4])
    rig.press()
    pad = await until(source, lambda pad: not pad.buttons[4])
    assert pad.presses == (0, 0, 0, 0, 1, 0)


async def test_a_pad_that_is_pulled_out_is_gone_and_says_why(source: JoystickSource, rig: Rig) -> None:
    rig.push(0, 1.0)
    await until(source, lambda pad: pad.axes[0] > 0.5)
    rig.unplug()
    pad = await until(source, lambda pad: not pad.connected)
    assert (pad.axes, pad.buttons) == ((), ())
    assert pad.reason.endswith(".")


async def test_it_comes_back_by_itself_and_what_is_held_then_is_no_press(
    source: JoystickSource, rig: Rig
) -> None:
    rig.unplug()
    await until(source, lambda pad: not pad.connected)
    rig.press(2)
    rig.plug()
    pad = await until(source, lambda pad: len(pad.buttons) == BUTTONS)
    assert (pad.openings, sum(pad.presses)) == (2, 0)
    await until(source, lambda pad: pad.openings == 2)
    rig.press()
    rig.press(3)
    pad = await until(source, lambda pad: len(pad.buttons) == BUTTONS and pad.buttons[3])
    assert (pad.presses[2], pad.presses[3]) == (0, 1)
