"""`bentod check`: every mistake of a config at once, or what the config means."""

import os
from pathlib import Path

import click

from bentod.cli.configs import find, read
from bentod.cli.joystick_words import explain_joystick
from bentod.cli.learning_words import sentences
from bentod.cli.muscle_words import explain_scheme
from bentod.cli.recognition_words import check_recognition, explain_recognition
from bentod.config import Config
from bentod.errors import ConfigError
from bentod.furnish import mind_of
from bentod.mind import Mind


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--emg", default="", help="Replace the EMG source, e.g. replay:FILE or replay:FILE#ARRAY.")
@click.option("--port", default="", help="Replace the driver's port.")
def check(file: Path, emg: str, port: str) -> None:
    """Check the config FILE and explain what it says. Exits with 1 if it has mistakes."""
    try:
        config = read(file, emg, port)
        mind = _mind(config, find(file))
    except ConfigError as error:
        for line in str(error).splitlines():
            click.echo(line, err=True)
        raise SystemExit(1) from error
    for line in explain(config, mind, str(file)):
        click.echo(line)


def _mind(config: Config, file: Path) -> Mind:
    """Raises ConfigError: what is to be learned or recognised makes no sense."""
    try:
        if config.emg:
            check_recognition(config.emg)
        return mind_of(config)
    except ConfigError as error:
        raise ConfigError(f"{file}: {error}") from error


def explain(config: Config, mind: Mind, name: str = "") -> list[str]:
    """The config in sentences. `mind`: of this config; `name`: of the config."""
    safety = config.safety
    lines = [
        f"{config.arm}: {len(config.joints)} joints {_explain_drivers(config)}, "
        f"{config.rate_hz:g} ticks a second.",
        f"It starts {safety.start}, ends {safety.exit}, and a fault makes it {safety.fault}.",
        f"A joint that does not answer is held after {safety.hold_after_s:g} s, "
        f"and after {safety.fault_after_s:g} s the arm is in fault.",
    ]
    lines += [
        f"  {joint.name}: {joint.min_rad:+.3f} to {joint.max_rad:+.3f} rad, "
        f"up to {joint.max_velocity_rad_s:g} rad/s, home at {joint.home_rad:+.3f} rad"
        for joint in config.joints
    ]
    lines += [f"Group {group.name}: {' → '.join(group.joints)}." for group in config.groups]
    lines += explain_joystick(config.joystick) if config.joystick else []
    return [*lines, *_explain_muscles(config), *_explain_mind(config, mind, name), *_explain_access(config)]


def _explain_drivers(config: Config) -> str:
    shares = config.shares()
    if len(shares) == 1:
        return f"on the driver '{shares[0].driver.name}'"
    named = (
        f"{', '.join(config.joints[index].name for index in share.joints)} on '{share.driver.name}' "
        f"([{share.place}])"
        for share in shares
    )
    return f"on {len(shares)} drivers ({'; '.join(named)})"


def _explain_muscles(config: Config) -> list[str]:
    if config.emg is None:
        return ["No muscles: there is no [emg] table."]
    emg = config.emg
    lines = [f"EMG from '{emg.source.name}' at {emg.rate_hz:g} Hz, {len(emg.sites)} sites."]
    lines += [f"  {sentence}" for _, table in emg.driven() for sentence in explain_scheme(table)]
    if emg.recognition:
        lines += [f"  {sentence}" for sentence in explain_recognition(emg.recognition)]
    return lines


def _explain_mind(config: Config, mind: Mind, name: str) -> list[str]:
    if mind.predictor is None:
        return ["Nothing is learned: there is no [learn] table."]
    lines = sentences(config, mind.predictor, name, os.environ)
    if config.assist and config.assist.mode != "off":
        assist = config.assist
        lines.append(
            f"Assist {assist.mode} moves unattended joints of the group {assist.group} "
            f"to where they are expected in {assist.timescale / config.rate_hz:.2f} s."
        )
    return lines


def _explain_access(config: Config) -> list[str]:
    access, tcp = config.access, config.tcp
    movers = ", ".join(["the daemon's own user", "root", *(f"the group {name}" for name in access.operators)])
    watchers = "whoever the socket lets in"
    if access.observers is not None:
        watchers = ", ".join(f"the group {name}" for name in access.observers) or "nobody else"
    lines = [f"It may be moved by {movers}; looked at, and stopped, by {watchers}."]
    if tcp:
        how = "with TLS" if tcp.certificate else "from this machine only"
        lines.append(f"Over TCP, {how}: {tcp.host} port {tcp.port}, for whoever has a token.")
    return lines
