"""`bentod calibrate`: how long a joint takes to obey, measured by small steps and written to the config."""

import asyncio
import math
from pathlib import Path

import click

from bentod import registry
from bentod.calibration.config_edit import rewrite
from bentod.calibration.procedure import Plan, record_steps
from bentod.calibration.summary import ACCELERATION, Summary, summarise
from bentod.cli.configs import find, read
from bentod.clock import SystemClock
from bentod.config import Config, Share
from bentod.contracts import ArmConfig, Clock
from bentod.errors import BentodError, ConfigError, Refused, nearest


@click.command()
@click.argument("joint")
@click.option("--config", type=click.Path(path_type=Path), required=True, help="Config file of the arm.")
@click.option("--port", default="", help="Replace the driver's port, e.g. by that of `bentod sim-bus`.")
@click.option("--step", type=click.FloatRange(1, 15), default=5.0, show_default=True, help="Degrees.")
@click.option("--pairs", type=click.IntRange(2, 10), default=4, show_default=True, help="Steps to and fro.")
@click.option("--write/--no-write", default=True, show_default=True, help="Change the config file.")
@click.option("--yes", is_flag=True, help="Do not ask first.")
def calibrate(joint: str, config: Path, port: str, step: float, pairs: int, write: bool, yes: bool) -> None:
    """Measure how long JOINT takes to obey, and how it slows down; write both to the config.

    The joint moves by itself in small steps within its limits. The daemon must not run on the same port.
    Ctrl-C stops the joint and writes nothing.
    """
    try:
        path = find(config)
        checked = read(path, port=port)
        index = _index(checked, joint)
        if not yes:
            click.confirm(_warning(checked, joint, step, pairs), abort=True)
        found = asyncio.run(_on_system_clock(checked, index, step, pairs))
        for line in found.lines():
            click.echo(line)
        _keep(path, checked, index, found, write)
    except BentodError as error:
        click.echo(f"bentod: {error}", err=True)
        raise SystemExit(1) from error
    except KeyboardInterrupt:
        click.echo("bentod: interrupted; the joint was stopped, nothing was written.", err=True)
        raise SystemExit(130) from None


async def measure(config: Config, index: int, step: float, pairs: int, clock: Clock) -> Summary:
    """Calibrate the joint of that index by steps of so many degrees, on its own driver alone.

    Raises:
        BentodError: the arm cannot be opened, there is no room, or the joint does not do as it is told.
    """
    share, specs = _share(config, index), tuple(joint.spec() for joint in config.joints)
    safety, spec = config.safety, specs[index]
    plan = Plan(
        joint=share.joints.index(index),
        step=math.radians(step),
        pairs=pairs,
        period=1 / config.rate_hz,
        lost_after=safety.hold_after_s,
        limp_after=safety.exit == "limp",
        limp_after_fault=safety.fault == "limp",
    )
    arm = ArmConfig(tuple(specs[i] for i in share.joints), 1 / config.rate_hz, share.driver.options)
    async with registry.open_joints(share.driver.name)(arm, clock) as joints:
        records = await record_steps(joints, spec, plan, clock, _progress)
    return summarise(records, spec.name, _believed(config, index))


async def _on_system_clock(config: Config, index: int, step: float, pairs: int) -> Summary:
    async with SystemClock() as clock:
        return await measure(config, index, step, pairs, clock)


def _keep(path: Path, config: Config, index: int, found: Summary, write: bool) -> None:
    """Write what was found, if that is wanted and the driver has a key for it."""
    if not found.trusted:
        raise Refused("the steps disagree, so nothing is written; try longer steps, or another posture.")
    driver, joint = _share(config, index).driver.name, config.joints[index]
    values = found.values(registry.driver_models(driver)[1].model_fields)
    if not values:
        click.echo(f"The driver '{driver}' has no keys for this; nothing is written.")
    for key, value in values.items() if write else ():
        click.echo(f"{path}: {joint.name}: {key} = {value:g} (was {joint.hardware.get(key, 'not set')})")
    if values and write:
        click.echo(f"The file as it was: {rewrite(path, joint.name, values, registry)}")


def _index(config: Config, name: str) -> int:
    names = [joint.name for joint in config.joints]
    if name not in names:
        raise ConfigError(f"there is no joint '{name}'{nearest(name, names)}")
    return names.index(name)


def _share(config: Config, index: int) -> Share:
    return next(share for share in config.shares() if index in share.joints)


def _believed(config: Config, index: int) -> float:
    value = config.joints[index].hardware.get(ACCELERATION, 0.0)
    return float(value) if isinstance(value, int | float) else 0.0


def _warning(config: Config, joint: str, step: float, pairs: int) -> str:
    left = "limp: what it carries falls" if config.safety.exit == "limp" else "holding"
    return (
        f"Joint {joint} gets torque and moves by itself, {step:g} degrees to one side and back, "
        f"{pairs} times. It is then left {left}. Keep clear of it, and the power switch at hand. Go on?"
    )


def _progress(line: str) -> None:
    click.echo(line, err=True)
