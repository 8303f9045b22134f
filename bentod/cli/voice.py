"""`bentod voice`: what the daemon does, to be heard, in a process of its own."""

import asyncio
from pathlib import Path

import click

from bentod import logs
from bentod.cli.configs import read
from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Misused, Way, failure
from bentod.cli.until_told import until_told
from bentod.config_voice import Voice
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError
from bentod.registry import open_player
from bentod.voice.narrator import Narrator
from bentod.voice.render import Renderer
from bentod.voice.settings import joints_of, table_of

PATIENCE_S = 5.0
"""How long the daemon may take to say how its arm sounds."""


@click.command()
@ADDRESS
@TOKEN_FILE
@CA_FILE
@click.option("--config", type=click.Path(path_type=Path), help="Sound as this config says.")
@click.option("--list", "listing", is_flag=True, help="Show every event and what it sounds like, and end.")
@click.option(
    "--render", metavar="FOLDER", type=click.Path(path_type=Path), help="Write every sound as a WAV, and end."
)
def voice(
    socket: str | None,
    token_file: Path | None,
    ca_file: Path | None,
    config: Path | None,
    listing: bool,
    render: Path | None,
) -> None:
    """Speak what the running daemon does, until Ctrl-C: joints that are selected, faults, marks.

    It reconnects by itself, and can neither move the arm nor delay it.
    """
    way = Way(socket or default_socket_path(), token_file, ca_file)
    try:
        if listing or render:
            _show(_renderer(way, config), listing, render)
            return
        table = read(config).voice if config else None
        with logs.setup("INFO"):
            asyncio.run(_speak(way, table))
    except BentodError as error:
        raise failure(error) from error


async def _speak(way: Way, table: Voice | None) -> None:
    """Speak until Ctrl-C or SIGTERM."""
    async with open_player()() as player:
        await until_told(Narrator(way.client, player, table).run())


def _renderer(way: Way, config: Path | None) -> Renderer:
    """Of the arm in `config`, or of the daemon's. Raises BentodError: neither can be read."""
    if config:
        read_config = read(config)
        return Renderer(read_config.voice, [joint.name for joint in read_config.joints])
    with way.blocking(PATIENCE_S) as arm:
        info = arm.call("get_info")
    return Renderer(table_of(info), joints_of(info))


def _show(renderer: Renderer, listing: bool, folder: Path | None) -> None:
    """Raises Misused: `folder` takes no files."""
    for event in renderer.events():
        if listing:
            click.echo(f"{event:<28} {renderer.words(event)}")
        if folder:
            _write(folder, event, renderer.wav((event,)))


def _write(folder: Path, event: str, wav: bytes | None) -> None:
    if wav is None:
        return
    try:
        folder.mkdir(parents=True, exist_ok=True)
        (folder / f"{event}.wav").write_bytes(wav)
    except OSError as error:
        raise Misused(f"{folder}: {error.strerror}.") from error
