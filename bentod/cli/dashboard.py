"""`bentod dashboard`: the page, served by a process of its own that is kept running."""

import asyncio
import socket as sockets
import sys
from dataclasses import replace
from pathlib import Path

import click

from bentod import logs
from bentod.cli.link import ADDRESS, CA_FILE, TOKEN_FILE, Way
from bentod.dashboard.doorkeeper import Tokens
from bentod.dashboard.extra import Serve, load_server
from bentod.dashboard.keeper import USELESS, Keeper, own_command, read_tokens
from bentod.dashboard.page_file import Links, announced, links, told_links
from bentod.dashboard.place import Place, listener
from bentod.endpoint import default_socket_path
from bentod.errors import BentodError
from bentod.token_file import read_token

PORT = 8780
"""Where browsers find the page, unless somebody else is there."""

_FILE = click.Path(path_type=Path)


@click.command()
@ADDRESS
@TOKEN_FILE
@CA_FILE
@click.option("--host", default="127.0.0.1", show_default=True, help="Address to listen on; others need TLS.")
@click.option("--port", type=click.IntRange(1, 65535), help=f"Default: {PORT}, or another if that is taken.")
@click.option("--name", "names", multiple=True, help="Another name of this machine, as in the browser's URL.")
@click.option("--certificate", type=_FILE, help="PEM file, for TLS.")
@click.option("--key", type=_FILE, help="PEM file, for TLS.")
@click.option(
    "--operator-token", type=_FILE, help="File with a token that stays the same; default: a new one."
)
@click.option("--observer-token", type=_FILE, help="The same for those who only look.")
@click.option("--urdf", type=_FILE, help="Shape of another arm than the Bento Arm.")
@click.option("--quiet", is_flag=True, help="Do not print the page's address; `bentod watch` shows it.")
@click.option("--where", is_flag=True, help="Print the addresses of the page that is being served, and end.")
@click.option("--listener", "descriptor", type=int, hidden=True, help="Of the keeper's socket.")
def dashboard(
    socket: str | None,
    token_file: Path | None,
    ca_file: Path | None,
    host: str,
    port: int | None,
    names: tuple[str, ...],
    certificate: Path | None,
    key: Path | None,
    operator_token: Path | None,
    observer_token: Path | None,
    urdf: Path | None,
    quiet: bool,
    where: bool,
    descriptor: int | None,
) -> None:
    """Show the arm in a browser, until Ctrl-C. The daemon may come and go."""
    way = Way(socket or default_socket_path(), token_file, ca_file)
    if where:
        _tell(way)
        return
    try:
        place = Place(host, port or PORT, names, certificate, key, urdf)
        if descriptor is not None:
            _work(place, descriptor, way)
            return
        load_server()  # rather now than in a process that is started again and again
        place.checked()
        tokens = _tokens(operator_token, observer_token)
        with listener(host, port, PORT) as found:
            here = replace(place, port=found.getsockname()[1])
            raise SystemExit(_keep(here, found, way, tokens, quiet))
    except BentodError as error:
        click.echo(f"bentod: {error}", err=True)
        raise SystemExit(USELESS) from error


def _keep(place: Place, found: sockets.socket, way: Way, tokens: Tokens, quiet: bool) -> int:
    page = links(place.address, tokens)
    with announced(way.address, page):
        ready = (lambda: None) if quiet else (lambda: _say(page))
        return Keeper(own_command(_arguments(place, way)), found.fileno(), tokens, ready).run()


def _tell(way: Way) -> None:
    page = told_links(way.address)
    if page is None:
        raise click.ClickException("This user serves no page of that daemon: bentod dashboard begins to.")
    _say(page)


def _say(page: Links) -> None:
    click.echo(f"The page is at {page.operator}")
    click.echo(f"To look only:   {page.observer}")


def _work(place: Place, descriptor: int, way: Way) -> None:
    serve, tokens = load_server(), read_tokens()
    with logs.setup("INFO", stream=sys.stderr, file=None), sockets.socket(fileno=descriptor) as found:
        asyncio.run(_serve(serve, place, found, tokens, way))


async def _serve(serve: Serve, place: Place, found: sockets.socket, tokens: Tokens, way: Way) -> None:
    await serve(place, found, tokens, way.client, _ready)


def _ready() -> None:
    sys.stdout.write("ready\n")
    sys.stdout.flush()


def _tokens(operator: Path | None, observer: Path | None) -> Tokens:
    """Those in the files, or new ones. Raises ConfigError: a file is no good."""
    new = Tokens.new()
    return Tokens(
        read_token(operator, "--operator-token") if operator else new.operator,
        read_token(observer, "--observer-token") if observer else new.observer,
    )


def _arguments(place: Place, way: Way) -> list[str]:
    given = {
        "--socket": way.address,
        "--token-file": way.token_file,
        "--ca-file": way.ca_file,
        "--host": place.host,
        "--port": place.port,
        "--certificate": place.certificate,
        "--key": place.key,
        "--urdf": place.urdf,
    }
    pairs = [(option, value) for option, value in given.items() if value is not None]
    pairs += [("--name", name) for name in place.names]
    return [word for option, value in pairs for word in (option, str(value))]
