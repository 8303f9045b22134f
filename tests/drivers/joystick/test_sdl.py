"""SDL: which pad is meant, and what is told when it cannot be had."""

from pathlib import Path
from types import SimpleNamespace

import pytest

from bentod import registry
from bentod.errors import ConfigError
from drivers.joystick import sdl
from drivers.joystick.sdl import open_joystick
from sim.clock import VirtualClock
from tests.drivers.joystick.rigs import Virtual, until


async def test_without_pygame_the_extra_that_brings_it_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ModuleNotFoundError(f"No module named '{name}'", name=name)

    monkeypatch.setattr(sdl, "importlib", SimpleNamespace(import_module=missing))
    with pytest.raises(ConfigError, match=r"pip install 'bentod\[joy\]' brings it"):
        async with open_joystick({}, VirtualClock()):
            pass


def test_the_source_can_be_chosen_without_pygame() -> None:
    assert registry.open_joystick("sdl") is open_joystick


@pytest.mark.real_time
async def test_a_pad_is_found_by_a_part_of_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pygame")
    monkeypatch.setattr(sdl, "RETRY_S", 0.01)
    async with open_joystick({"pad": "VIRTUAL"}, VirtualClock()) as source:
        rig = Virtual()
        told = await until(source, lambda pad: "no joystick" in pad.reason)
        await rig.first()
        await until(source, lambda pad: pad.connected)
        rig.unplug()
        gone = await until(source, lambda pad: not pad.connected)
    assert told.reason == "SDL finds no joystick 'VIRTUAL' (there: none)."
    assert "was unplugged" in gone.reason or "no joystick" in gone.reason


@pytest.mark.real_time
async def test_a_number_that_is_not_there_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("pygame")
    async with open_joystick({"pad": 7}, VirtualClock()) as source:
        pad = await until(source, lambda pad: "number 7" in pad.reason)
    assert pad.reason == "SDL finds 0 joysticks; number 7, counted from 0, is not among them."
