"""Browsers without a picture: they take in every frame as the page does, until standard input ends."""

import asyncio
import sys

import aiohttp
import msgpack

ACKNOWLEDGE = 3
"""Frames between two acknowledgements, as in the page (link.js)."""


async def _look(url: str, http: aiohttp.ClientSession) -> None:
    place, _, token = url.partition("#")
    headers = {"Origin": place.rstrip("/")}
    async with http.ws_connect(f"{place}ws", headers=headers, max_msg_size=0) as socket:
        await socket.send_bytes(msgpack.packb(["token", token]))
        async for message in socket:
            kind, number, *_ = msgpack.unpackb(message.data)
            if kind == "frame" and number % ACKNOWLEDGE == 0:
                await socket.send_bytes(msgpack.packb(["seen", number]))


async def _run(url: str, browsers: int) -> None:
    loop = asyncio.get_running_loop()
    ended = asyncio.Event()
    loop.add_reader(0, ended.set)
    async with aiohttp.ClientSession() as http:
        tasks = [asyncio.create_task(_look(url, http)) for _ in range(browsers)]
        await ended.wait()
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


if __name__ == "__main__":
    asyncio.run(_run(sys.argv[1], int(sys.argv[2])))
