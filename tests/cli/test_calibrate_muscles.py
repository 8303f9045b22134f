"""`bentod calibrate emg` and `bentod ctl emg-save`: clients of a whole daemon, whose wearer does as told."""

import asyncio
import signal
import subprocess
import tomllib
from contextlib import suppress
from pathlib import Path

import pytest
from click.testing import CliRunner

from bentod.calibration.measuring import Plan, apply
from bentod.cli.calibrating import calibrate
from bentod.cli.calibrating_muscles import measure
from bentod.cli.ctl import ctl
from bentod.client import Client
from bentod.config import Config
from bentod.errors import ConfigError, Refused
from tests.rig import CONFIGS, PLAIN, number, running, sim_config, table, tables, wait_for
from tests.system.processes import BENTOD, daemon, environment

PLAN = Plan(ready=0.5, rest=2.0, hold=1.5)
LONG = Plan(ready=1.0, rest=30.0, hold=2.0)
BEGIN = 1.5
"""s after the wearer's first sample, at which `PLAN` fits what the obedient one does."""


def without_learning(config: Config) -> Config:
    return config.model_copy(update={"learn": None, "assist": None})


def obedient(weakest: float = 1.0) -> Config:
    """A wearer who from `BEGIN` on does what `PLAN` asks for, a little early and for a little longer."""
    steps = [[0, 0.0, 4.4], [0, 1.0, 2.0], [1, weakest, 2.1], [2, 1.0, 3.0], [0, 0.0, 60.0]]
    changed = ('name = "synthetic"', f'name = "synthetic"\nlag_s = 0.0\nprogram = {steps}')
    return without_learning(sim_config(PLAIN, changed))


async def begun(arm: Client) -> None:
    """Wait for `BEGIN`."""
    await wait_for(arm, lambda frame: number(table(frame["emg"]), "next_index") >= BEGIN * 200)


def quiet(_: str) -> None:
    pass


async def watch(arm: Client, speeds: list[float]) -> None:
    """Keep how fast each joint is (rad/s) in every frame."""
    async for frame in arm.subscribe_state(rate_hz=500):
        speeds += [number(joint, "velocity") for joint in tables(frame, "joints")]


async def is_paused(arm: Client) -> bool:
    return bool(table(await arm.call("emg_get"))["paused"])


async def test_every_site_is_measured_set_live_and_emg_is_left_as_it_was(tmp_path: Path) -> None:
    said: list[str] = []
    speeds: list[float] = []
    async with running(obedient(), tmp_path / "s") as arm:
        await begun(arm)
        watching = asyncio.create_task(watch(arm, speeds))
        found = await measure(arm, PLAN, said.append)
        watching.cancel()
        for one in found:
            assert one.rest == pytest.approx(2.5e-6, rel=0.15)
            toggle = one.site == "other_forearm"
            assert one.threshold == pytest.approx(0.3 * one.contraction if toggle else 4.5e-6, rel=0.15)
            assert one.contraction == pytest.approx(62e-6 * 1.4, rel=0.25)  # of means that scatter
            assert one.maximum == pytest.approx(0.8 * one.contraction, rel=0.01)
            assert one.separable
        assert not await is_paused(arm)
        assert await apply(arm, found) == ["flexor", "extensor", "other_forearm"]
        sites = tables(table(await arm.call("emg_get")), "sites")
        assert [site["threshold_v"] for site in sites] == [one.threshold for one in found]
        assert [site["max_v"] for site in sites] == [one.maximum for one in found]
    assert said[:2] == ["In 0.5 s, for 2 s: relax every muscle.", "Now, for 2 s: relax every muscle!"]
    assert len(speeds) > 500
    assert max(map(abs, speeds)) == 0
    assert "contract the muscle of site extensor" in " ".join(said)


async def test_a_site_that_hardly_stands_out_is_not_changed(tmp_path: Path) -> None:
    async with running(obedient(weakest=0.08), tmp_path / "s") as arm:
        await begun(arm)
        found = await measure(arm, PLAN, quiet)
        assert [one.separable for one in found] == [True, False, True]
        assert await apply(arm, found) == ["flexor", "other_forearm"]
        assert tables(table(await arm.call("emg_get")), "sites")[1]["max_v"] == 30e-6


@pytest.mark.parametrize("was", [True, False])
async def test_who_breaks_off_finds_emg_paused_only_if_it_was(tmp_path: Path, was: bool) -> None:
    async with running(without_learning(sim_config(PLAIN)), tmp_path / "s") as arm:
        await arm.call("emg_pause", on=was)
        measuring = asyncio.create_task(measure(arm, LONG, quiet))
        await asyncio.sleep(5.0)
        assert await is_paused(arm)
        measuring.cancel()
        with suppress(asyncio.CancelledError):
            await measuring
        assert await is_paused(arm) is was


async def test_it_ends_when_somebody_lets_the_muscles_drive_again(tmp_path: Path) -> None:
    async with running(without_learning(sim_config(PLAIN)), tmp_path / "s") as arm:
        measuring = asyncio.create_task(measure(arm, LONG, quiet))
        await asyncio.sleep(5.0)
        await arm.call("emg_pause", on=False)
        with pytest.raises(Refused, match="somebody let the muscles drive again"):
            await measuring


async def test_an_unknown_site_and_an_arm_without_muscles_are_told(tmp_path: Path) -> None:
    async with running(without_learning(sim_config(PLAIN)), tmp_path / "s") as arm:
        with pytest.raises(ConfigError, match="did you mean 'flexor'"):
            await measure(arm, Plan(sites=("flexr",)), quiet)
    mute = without_learning(sim_config(PLAIN)).model_copy(update={"emg": None})
    async with running(mute, tmp_path / "t") as arm:
        with pytest.raises(ConfigError, match=r"no \[emg\] table"):
            await measure(arm, PLAN, quiet)


async def test_levels_are_told_after_gain_and_follow_the_samples(tmp_path: Path) -> None:
    async with running(obedient(), tmp_path / "s") as arm:
        await arm.call("emg_set", site="flexor", gain=2.0)
        await begun(arm)
        told = table(await arm.call("emg_levels"))
        assert told["leads_off"] == {}
        levels = table(told["levels_v"])
        assert 2 < number(levels, "flexor") * 1e6 < 10
        assert 1 < number(levels, "extensor") * 1e6 < 5


@pytest.mark.real_time
def test_settings_are_kept_with_one_command_and_ctrl_c_leaves_everything_as_it_was(tmp_path: Path) -> None:
    config = tmp_path / "arm.toml"
    text = (CONFIGS / "sim.toml").read_text(encoding="utf-8")
    config.write_text(text, encoding="utf-8")
    with daemon(tmp_path, "--config", str(config), "--no-record") as process:
        path = ["--socket", str(process.socket)]
        ask = CliRunner().invoke
        assert ask(ctl, [*path, "emg-save", str(config)]).output == f"{config}: nothing to change\n"
        assert ask(ctl, [*path, "emg-set", "flexor", "gain=2", "max_v=5e-5"]).exit_code == 0
        kept = ask(ctl, [*path, "emg-save", str(config)])
        assert f"{config}: flexor: max_v = 5e-05 (was 3e-05)" in kept.output
        site = tomllib.loads(config.read_text(encoding="utf-8"))["emg"]["sites"][0]
        assert (site["gain"], site["threshold_v"], site["max_v"]) == (2.0, 10e-6, 5e-5)
        assert (tmp_path / "arm.toml.bak").read_text(encoding="utf-8") == text
        other = ask(ctl, [*path, "emg-save", "bento.toml"])
        assert (other.exit_code, "there is no EMG site 'flexor'" in other.output) == (2, True)

        words = [*BENTOD, "calibrate", "emg", "--yes", "--write", str(config), *path]
        with subprocess.Popen(
            words, stderr=subprocess.PIPE, text=True, env=environment(tmp_path)
        ) as calibrating:
            assert calibrating.stderr
            assert "relax every muscle" in calibrating.stderr.readline()
            with process.client() as arm:
                assert table(arm.call("emg_get"))["paused"] is True
                calibrating.send_signal(signal.SIGINT)
                assert "interrupted; EMG is left as it was found" in calibrating.stderr.read()
                assert table(arm.call("emg_get"))["paused"] is False
        assert calibrating.returncode == 130
        assert tomllib.loads(config.read_text(encoding="utf-8"))["emg"]["sites"][0]["max_v"] == 5e-5


def test_what_is_no_command_is_the_name_of_a_joint() -> None:
    done = CliRunner().invoke(calibrate, ["griper", "--config", "sim.toml", "--yes"])
    assert "there is no joint 'griper'; did you mean 'gripper'?" in done.output
    assert "threshold" in CliRunner().invoke(calibrate, ["emg", "--help"]).output
