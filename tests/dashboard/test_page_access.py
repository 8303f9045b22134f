"""Strangers: pages of others, other names, no token. A real server, and a real browser that is lured."""

import aiohttp
import msgpack
import pytest
from aiohttp import web

from bentod.dashboard.web import BROWSERS
from tests.dashboard.chromium import Browser
from tests.dashboard.page import Page
from tests.dashboard.rig import Lab

pytestmark = pytest.mark.real_time


async def test_a_foreign_page_cannot_speak_to_the_arm(browser: Browser, site: Lab) -> None:
    async def foreign(request: web.Request) -> web.Response:
        return web.Response(text="<title>free games</title>", content_type="text/html")

    application = web.Application()
    application.router.add_get("/", foreign)
    runner = web.AppRunner(application)
    await runner.setup()
    listening = web.TCPSite(runner, "127.0.0.1", 0)
    await listening.start()
    port = runner.addresses[0][1]
    page = await browser.page(f"http://127.0.0.1:{port}/")
    await page.until("document.title === 'free games'")
    tried = await page.eval(
        f"new Promise(done => {{ const s = new WebSocket('ws://{site.place}/ws');"
        "s.onopen = () => done('open'); s.onerror = () => done('refused') })"
    )
    read = await page.eval(f"fetch('http://{site.place}/').then(() => 'read', () => 'refused')")
    framed = await page.eval(
        "new Promise(done => { const f = document.createElement('iframe'); f.onload = () => {"
        "let seen = 'refused'; try { seen = f.contentDocument ? 'read' : seen } catch { } done(seen) };"
        f"f.src = 'http://{site.place}/'; document.body.append(f) }})"
    )
    await runner.cleanup()
    assert (tried, read, framed) == ("refused", "refused", "refused")


async def test_a_name_that_is_not_the_servers_gets_nothing(site: Lab) -> None:
    async with aiohttp.ClientSession() as http:
        async with http.get(f"http://{site.place}/", headers={"Host": "evil.example"}) as answer:
            assert answer.status == 421
        async with http.get(f"http://{site.place}/") as answer:
            assert answer.status == 200
            assert "script-src 'self'" in answer.headers["Content-Security-Policy"]
            assert answer.headers["Referrer-Policy"] == "no-referrer"
            assert answer.headers["X-Frame-Options"] == "DENY"


@pytest.mark.parametrize(
    "path", ["/../place.py", "/static/index.html", "/models/", "/page.js.map", "//etc/passwd"]
)
async def test_nothing_is_served_but_the_page(site: Lab, path: str) -> None:
    async with aiohttp.ClientSession() as http, http.get(f"http://{site.place}{path}") as answer:
        assert answer.status == 404


@pytest.mark.parametrize(
    "first",
    [["token", "wrong"], ["call", 1, "stop", {}], ["token", ""], "hello", None, ["token", "x" * 9000]],
)
async def test_without_a_token_nothing_is_told(site: Lab, first: object) -> None:
    headers = {"Origin": f"http://{site.place}"}
    async with (
        aiohttp.ClientSession() as http,
        http.ws_connect(f"http://{site.place}/ws", headers=headers) as socket,
    ):
        await socket.send_bytes(msgpack.packb(first))
        message = await socket.receive(5.0)
        assert message.type is aiohttp.WSMsgType.CLOSE
        assert message.data == 4401


async def test_a_message_that_is_too_long_ends_the_connection_and_nothing_else(site: Lab) -> None:
    token = site.operator.partition("#")[2]
    headers = {"Origin": f"http://{site.place}"}
    async with (
        aiohttp.ClientSession() as http,
        http.ws_connect(f"http://{site.place}/ws", headers=headers) as socket,
    ):
        await socket.send_bytes(msgpack.packb(["token", token]))
        assert (await socket.receive(5.0)).type is aiohttp.WSMsgType.BINARY
        await socket.send_bytes(bytes(100_000))
        while (message := await socket.receive(5.0)).type is aiohttp.WSMsgType.BINARY:
            pass
        assert message.type in (aiohttp.WSMsgType.CLOSE, aiohttp.WSMsgType.CLOSED)
    assert site.server.poll() is None


async def test_the_token_leaves_the_address_and_is_asked_for_nowhere(page: Page, site: Lab) -> None:
    token = site.operator.partition("#")[2]
    assert await page.eval("location.href") == f"http://{site.place}/"
    assert page.requests
    for url in page.requests:
        assert token not in url.partition("#")[0]
        assert url.startswith((f"http://{site.place}/", f"ws://{site.place}/", "data:", "blob:")), (
            "no stranger is asked"
        )
    for name in ("server.err", "daemon.err", "daemon.out"):
        assert token not in (site.folder / name).read_text()


async def test_a_page_without_a_token_asks_for_one_and_takes_it(browser: Browser, site: Lab) -> None:
    page = await browser.page(f"http://{site.place}/")
    await page.until("!!document.querySelector('#token')")
    await page.fill("#token", "wrong" * 10)
    await page.click("form button")
    await page.until("document.body?.innerText.includes('not valid')")
    await page.fill("#token", site.operator)
    await page.click("form button")
    await page.until("!!window.bentod?.frame")


async def test_those_who_knock_and_say_nothing_keep_nobody_out(site: Lab) -> None:
    headers = {"Origin": f"http://{site.place}"}
    async with aiohttp.ClientSession(connector=aiohttp.TCPConnector(limit=0)) as http:
        silent = [
            await http.ws_connect(f"http://{site.place}/ws", headers=headers) for _ in range(BROWSERS + 6)
        ]
        async with http.ws_connect(f"http://{site.place}/ws", headers=headers) as guest:
            await guest.send_bytes(msgpack.packb(["token", site.operator.partition("#")[2]]))
            assert (await guest.receive(5.0)).type is aiohttp.WSMsgType.BINARY
        for one in silent:
            await one.close()
