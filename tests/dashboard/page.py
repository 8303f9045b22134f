"""One page in a real browser, and what a person does with it."""

import asyncio
import base64
import json
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any, Protocol

PATIENCE = 20.0
"""s that anything may take on a busy machine."""


class Wire(Protocol):
    """The connection to the browser."""

    async def send(self, method: str, params: dict[str, Any], session: str | None = None) -> Any:
        """Ask for something; the answer."""
        ...


class Page:
    """One tab, in a window of its own that shares nothing with others."""

    def __init__(self, wire: Wire, session: str) -> None:
        self._wire = wire
        self._session = session
        self.requests: list[str] = []
        self.problems: list[str] = []
        """What the console was told: errors, warnings, uncaught exceptions, broken policies."""

    async def send(self, method: str, **params: object) -> Any:
        """Ask the browser for something; a table."""
        return await self._wire.send(method, params, self._session)

    async def eval(self, script: str) -> Any:
        """What a JavaScript expression comes to; a promise is waited for."""
        answer = await self.send(
            "Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True, userGesture=True
        )
        failed = answer.get("exceptionDetails")
        assert not failed, f"{script}: {failed}"
        return answer["result"].get("value")

    async def until(self, script: str, seconds: float = PATIENCE) -> Any:
        """What the expression comes to, once that is true."""
        deadline = time.monotonic() + seconds
        while not (found := await self.eval(script)):
            assert time.monotonic() < deadline, f"not within {seconds:g} s: {script}\n{await self.text()}"
            await asyncio.sleep(0.03)
        return found

    async def text(self) -> str:
        """What the page shows."""
        return str(await self.eval("document.body?.innerText ?? ''"))

    async def goto(self, url: str) -> None:
        """Open an address."""
        await self.send("Page.navigate", url=url)

    async def before_scripts(self, script: str) -> None:
        """Have `script` run before those of every page that is opened from now on."""
        await self.send("Page.addScriptToEvaluateOnNewDocument", source=script)

    async def place(self, selector: str) -> tuple[float, float]:
        """The middle of an element that can be seen, once there is one and it stays where it is."""
        quoted = json.dumps(selector)
        before: list[float] = []
        while True:
            found = await self.until(
                f"(() => {{ const e = document.querySelector({quoted});"
                "if (!e?.getClientRects().length) return null;"
                "e.scrollIntoView({block: 'center', inline: 'center', behavior: 'instant'});"
                "const r = e.getBoundingClientRect(); return [r.x + r.width / 2, r.y + r.height / 2] })()"
            )
            if found == before:
                return found[0], found[1]
            before = found
            await self.eval("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    async def mouse(self, kind: str, x: float, y: float) -> None:
        """`kind`: mousePressed, mouseReleased or mouseMoved."""
        pressed = kind == "mousePressed"
        button = {"button": "left", "buttons": int(pressed), "clickCount": 1}
        if kind == "mouseMoved":
            button = {"button": "left", "buttons": 1}
        await self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **button)

    async def click(self, selector: str) -> None:
        """As a person does, with the pointer."""
        x, y = await self.place(selector)
        await self.mouse("mousePressed", x, y)
        await self.mouse("mouseReleased", x, y)

    @asynccontextmanager
    async def held(self, selector: str) -> AsyncIterator[None]:
        """While entered, the pointer holds the element down."""
        x, y = await self.place(selector)
        await self.mouse("mousePressed", x, y)
        try:
            yield
        finally:
            await self.mouse("mouseReleased", x, y)

    async def drag(self, selector: str, dx: float, dy: float, steps: int = 4) -> None:
        """Take an element by its middle and put it somewhere else."""
        x, y = await self.place(selector)
        await self.mouse("mousePressed", x, y)
        for step in range(1, steps + 1):
            await self.mouse("mouseMoved", x + dx * step / steps, y + dy * step / steps)
        await self.mouse("mouseReleased", x + dx, y + dy)

    async def key_down(self, key: str) -> None:
        """`key`: as JavaScript names it, e.g. Escape, ArrowUp, p."""
        typed = {"text": key} if len(key) == 1 else {}
        await self.send("Input.dispatchKeyEvent", type="keyDown", key=key, code=_code(key), **typed)

    async def key_up(self, key: str) -> None:
        """The same key goes up again."""
        await self.send("Input.dispatchKeyEvent", type="keyUp", key=key, code=_code(key))

    async def key(self, key: str) -> None:
        """Press and let go."""
        await self.key_down(key)
        await self.key_up(key)

    async def fill(self, selector: str, text: str) -> None:
        """Put `text` into a field, as if typed and left."""
        quoted = json.dumps(selector)
        await self.until(f"!!document.querySelector({quoted})")
        await self.eval(
            f"(() => {{ const e = document.querySelector({quoted}); e.focus(); e.value = {json.dumps(text)};"
            "e.dispatchEvent(new Event('input', {bubbles: true}));"
            "e.dispatchEvent(new Event('change', {bubbles: true})) })()"
        )

    async def hide(self, hidden: bool = True) -> None:
        """Have the page believe that another tab is in front of it."""
        state, truth = ("hidden", "true") if hidden else ("visible", "false")
        await self.eval(
            f"Object.defineProperty(document, 'hidden', {{value: {truth}, configurable: true}});"
            f"Object.defineProperty(document, 'visibilityState', {{value: '{state}', configurable: true}});"
            "document.dispatchEvent(new Event('visibilitychange'))"
        )

    async def offline(self, on: bool = True) -> None:
        """Cut the page off, or let it through again."""
        await self.send(
            "Network.emulateNetworkConditions",
            offline=on,
            latency=0,
            downloadThroughput=-1,
            uploadThroughput=-1,
        )

    async def size(self, width: int, height: int, mobile: bool = False) -> None:
        """Of the window, in CSS pixels."""
        await self.send(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=mobile,
        )

    async def scheme(self, name: str) -> None:
        """`dark` or `light`, as the system would say."""
        await self.send(
            "Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": name}]
        )

    async def screenshot(self, path: Path) -> None:
        """A PNG of the window."""
        taken = await self.send("Page.captureScreenshot", format="png")
        path.write_bytes(base64.b64decode(taken["data"]))

    def hear(self, event: dict[str, Any]) -> None:
        """Take in what the browser tells of this tab."""
        params = event["params"]
        match event["method"]:
            case "Network.requestWillBeSent":
                self.requests.append(params["request"]["url"])
            case "Network.webSocketCreated":
                self.requests.append(params["url"])
            case "Runtime.exceptionThrown":
                details = params["exceptionDetails"]
                self.problems.append(str(details.get("exception", {}).get("description", details["text"])))
            case "Log.entryAdded" if params["entry"]["level"] in ("error", "warning"):
                self.problems.append(params["entry"]["text"])
            case "Runtime.consoleAPICalled" if params["type"] in ("error", "warning", "assert"):
                self.problems.append(str([one.get("value") for one in params["args"]]))


def _code(key: str) -> str:
    if len(key) == 1 and key.isalpha():
        return f"Key{key.upper()}"
    return "Space" if key == " " else key
