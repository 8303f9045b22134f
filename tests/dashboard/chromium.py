"""A real Chromium, told what to do by its debugging protocol (Chrome DevTools Protocol), and its pages."""

import asyncio
import itertools
import json
import os
import shutil
import subprocess
import time
from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager, contextmanager, suppress
from pathlib import Path
from typing import Any, Self

import aiohttp
import pytest

from tests.dashboard.page import PATIENCE, Page

NAMES = ("chromium", "chromium-browser", "google-chrome")
"""Of the program; Debian's is the first."""

_OPTIONS = [
    "--headless=new",
    "--no-sandbox",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--disable-extensions",
    "--mute-audio",
    "--disable-background-networking",
    "--disable-sync",
    "--disable-component-update",
    "--password-store=basic",
    "--autoplay-policy=user-gesture-required",
    "--force-device-scale-factor=1",
    "--hide-scrollbars",
    "--disable-features=Translate,OptimizationHints,MediaRouter",
    "--remote-debugging-port=0",
    "about:blank",
]
_WITHOUT_WEBGL = ("--disable-gpu", "--disable-3d-apis", "--disable-software-rasterizer")
_WITH_WEBGL = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")


def program() -> str:
    """Chromium's; skips the test where there is none, unless BENTOD_BROWSER=required."""
    found = next(filter(None, map(shutil.which, NAMES)), "")
    if not found and os.environ.get("BENTOD_BROWSER") == "required":
        pytest.fail("there is no Chromium, and it is required")
    return found or pytest.skip("needs Chromium (Debian: apt install chromium)")


@contextmanager
def chromium(folder: Path, webgl: bool = False) -> Iterator[str]:
    """The address of a browser that keeps its files in `folder`."""
    command = [program(), f"--user-data-dir={folder}", *(_WITH_WEBGL if webgl else _WITHOUT_WEBGL), *_OPTIONS]
    with subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) as process:
        try:
            yield _address(folder / "DevToolsActivePort", process)
        finally:
            process.terminate()
            with suppress(subprocess.TimeoutExpired):
                process.wait(PATIENCE)
            process.kill()


def _address(file: Path, process: "subprocess.Popen[bytes]") -> str:
    deadline = time.monotonic() + PATIENCE
    while not (file.exists() and file.read_text().count("\n")):
        assert process.poll() is None, "Chromium ended"
        assert time.monotonic() < deadline, "Chromium did not begin"
        time.sleep(0.02)
    port, path = file.read_text().splitlines()
    return f"ws://127.0.0.1:{port}{path}"


class _Wire:
    """The connection to the browser: commands with numbers, events with sessions."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self.pages: dict[str, Page] = {}
        self._socket = socket
        self._numbers = itertools.count(1)
        self._open: dict[int, asyncio.Future[Any]] = {}

    async def send(self, method: str, params: dict[str, Any], session: str | None = None) -> Any:
        number = next(self._numbers)
        answer = self._open[number] = asyncio.get_running_loop().create_future()
        to = {"sessionId": session} if session else {}
        await self._socket.send_str(json.dumps({"id": number, "method": method, "params": params} | to))
        async with asyncio.timeout(PATIENCE):
            return await answer

    async def listen(self) -> None:
        async for message in self._socket:
            told = json.loads(message.data)
            if "id" in told:
                self._settle(told)
            elif page := self.pages.get(told.get("sessionId", "")):
                page.hear(told)

    def _settle(self, told: dict[str, Any]) -> None:
        answer = self._open.pop(told["id"])
        if answer.done():
            return
        if "error" in told:
            answer.set_exception(RuntimeError(str(told["error"])))
        else:
            answer.set_result(told["result"])


class Browser:
    """`async with Browser.at(address) as browser: page = await browser.page()`."""

    def __init__(self, wire: _Wire) -> None:
        self._wire = wire

    @classmethod
    @asynccontextmanager
    async def at(cls, address: str) -> AsyncIterator[Self]:
        """Speak to the browser there; the windows that were opened are closed in the end."""
        async with aiohttp.ClientSession() as http, http.ws_connect(address, max_msg_size=0) as socket:
            wire = _Wire(socket)
            listener = asyncio.create_task(wire.listen())
            browser = cls(wire)
            browser._contexts = []
            try:
                yield browser
            finally:
                for context in browser._contexts:
                    await wire.send("Target.disposeBrowserContext", {"browserContextId": context})
                listener.cancel()
                await asyncio.gather(listener, return_exceptions=True)

    _contexts: list[str]

    async def page(self, url: str = "") -> Page:
        """A new window."""
        context = (await self._wire.send("Target.createBrowserContext", {}))["browserContextId"]
        self._contexts.append(context)
        target = await self._wire.send(
            "Target.createTarget",
            {"url": "about:blank", "browserContextId": context, "width": 1440, "height": 900},
        )
        attached = await self._wire.send(
            "Target.attachToTarget", {"targetId": target["targetId"], "flatten": True}
        )
        page = self._wire.pages[attached["sessionId"]] = Page(self._wire, attached["sessionId"])
        for domain in ("Page", "Runtime", "Network", "Log"):
            await page.send(f"{domain}.enable")
        await page.size(1440, 900)
        if url:
            await page.goto(url)
        return page
