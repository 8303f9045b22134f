"""One run of the page's server, from its arguments to its end."""

import asyncio
import signal
import socket as sockets
from collections.abc import Callable

from bentod.dashboard.actor import Connect
from bentod.dashboard.assets import STATIC, build_of, read_assets
from bentod.dashboard.doorkeeper import Doorkeeper, Tokens
from bentod.dashboard.place import Place
from bentod.dashboard.site import Site
from bentod.dashboard.web import Server


async def serve(
    place: Place, listener: sockets.socket, tokens: Tokens, connect: Connect, ready: Callable[[], None]
) -> None:
    """Serve until SIGINT, SIGTERM or the end of standard input; `ready` is called once browsers are let in.

    Raises:
        ConfigError: the page or the certificate cannot be had.
    """
    assets = read_assets(STATIC, place.urdf)
    door = Doorkeeper((place.host, *place.names), place.port, place.certificate is not None)
    site = Site(connect, build_of(assets))
    server = Server(site, assets, tokens, door)
    async with server.serving(listener, place.checked()):
        ready()
        await _until_ended(site)


async def _until_ended(site: Site) -> None:
    ended = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGINT, signal.SIGTERM):
        loop.add_signal_handler(number, ended.set)
    loop.add_reader(0, ended.set)  # the keeper says no more: standard input ends when it is gone
    running = asyncio.create_task(site.run())
    waiting = asyncio.create_task(ended.wait())
    try:
        await asyncio.wait([running, waiting], return_when=asyncio.FIRST_COMPLETED)
    finally:
        loop.remove_reader(0)
        running.cancel()
        waiting.cancel()
        await asyncio.gather(running, waiting, return_exceptions=True)
    if running.done() and not running.cancelled():
        running.result()
