"""A bare MessagePack echo server on a Unix socket: what a request costs where nothing is done for it."""

import asyncio
import sys

import msgpack


class Echo(asyncio.Protocol):
    """Answers [0, id, "echo", x] with x, and "kept" with what was last sent to "keep"."""

    kept: object = None

    def __init__(self) -> None:
        self._unpacker = msgpack.Unpacker()

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        assert isinstance(transport, asyncio.Transport)
        self._transport = transport

    def data_received(self, data: bytes) -> None:
        self._unpacker.feed(data)
        for _, id_, method, params in self._unpacker:
            if method == "keep":
                Echo.kept = params
            result = Echo.kept if method == "kept" else params
            self._transport.write(msgpack.packb([1, id_, None, result]))


async def main(path: str) -> None:
    """Serve until ended."""
    server = await asyncio.get_running_loop().create_unix_server(Echo, path)
    await server.serve_forever()


if __name__ == "__main__":
    asyncio.run(main(sys.argv[1]))
