"""What the tests of the doors share: a server that lets people in by group or token, and such people."""

import asyncio
import grp
import os
import shutil
import ssl
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from bentod.config_tables import Access, Tcp
from bentod.frames import Value
from bentod.messages import Notification, Response, encode_request
from bentod.serve.server import Server
from bentod.serve.session import Bounds, Session
from bentod.serve.spec import table
from bentod.serve.unix_door import UnixDoor
from bentod.token_file import proof
from tests.serve.helpers import TOYS, Plug

TLS = Path(__file__).parent / "tls"
"""A certificate for localhost that signs itself, its key, and the same key with a password."""

OPERATOR, OBSERVER = "operator-" + "o" * 32, "observer-" + "w" * 32

NOBODY = frozenset((2**31 - 1,))
"""The daemon's own user, in tests where we are somebody else."""

OURS = grp.getgrgid(os.getgid()).gr_name
"""A group that we are in."""


async def move(session: Session) -> Value:
    """Move the arm."""
    return "moved"


def strict(
    path: Path,
    access: Access | None = None,
    *,
    tcp: Tcp | None = None,
    bounds: Bounds | None = None,
    masters: frozenset[int] = NOBODY,
) -> Server:
    """A server whose toys anybody may use, and whose `move` is for operators."""
    unix = UnixDoor(access or Access(), masters)
    methods = table(observer=TOYS, operator=(move,))
    return Server(methods, path, bounds, unix=unix, tcp=tcp)


@dataclass(frozen=True, slots=True)
class Files:
    """Private files as a daemon and its clients have them."""

    folder: Path

    def secret(self, name: str, content: str, mode: int = 0o600) -> Path:
        path = self.folder / name
        path.write_text(content)
        path.chmod(mode)
        return path

    def tcp(self, **changes: object) -> Tcp:
        """A table for loopback without TLS, at any free port; the roles' tokens are OPERATOR and OBSERVER."""
        tokens = {
            "operator_token": self.secret("operator", OPERATOR + "\n"),
            "observer_token": self.secret("observer", OBSERVER),
        }
        return Tcp.model_validate(tokens | changes).model_copy(update={"port": 0})

    def with_tls(self) -> Tcp:
        """The same with TLS."""
        key = self.folder / "key.pem"
        shutil.copyfile(TLS / "key.pem", key)
        key.chmod(0o600)
        return self.tcp(certificate=TLS / "certificate.pem", key=key)


@asynccontextmanager
async def dialled(
    server: Server, tls: bool = False, source: tuple[str, int] | None = None
) -> AsyncIterator[Plug]:
    """A raw connection over TCP."""
    context = ssl.create_default_context(cafile=TLS / "certificate.pem") if tls else None
    reader, writer = await asyncio.open_connection(*server.addresses[0], ssl=context, local_addr=source)
    try:
        yield Plug(reader, writer)
    finally:
        writer.transport.abort()
        await asyncio.sleep(0)


async def prove(plug: Plug, token: str) -> None:
    """Ask to be let in, as one should; the answer is still to come."""
    plug.ask(1, "challenge")
    match await plug.next():
        case Response(result={"nonce": str(nonce)}):
            plug.writer.write(encode_request(1, "authenticate", {"proof": proof(token, nonce)}))


async def said(plug: Plug) -> str:
    """The next message as one text: an error's sentence, or what came."""
    match await plug.next():
        case Response(error={"message": str(text)}) | Notification("error", [{"message": str(text)}]):
            return text
        case None:
            return "(closed)"
        case Response(result=result):
            return str(result)
        case other:
            return str(other)
