"""Where the page is: a file of the user who serves it, for that user alone."""

import hashlib
import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from bentod.address import parse
from bentod.dashboard.doorkeeper import Tokens
from bentod.endpoint import default_socket_path
from bentod.whole_file import replacing

_PRIVATE = 0o600


@dataclass(frozen=True, slots=True)
class Links:
    """The page's address with a token: in the fragment, which no browser sends anywhere."""

    operator: str
    observer: str


def links(address: str, tokens: Tokens) -> Links:
    """The two addresses of a page."""
    return Links(f"{address}#{tokens.operator}", f"{address}#{tokens.observer}")


def page_file(address: Path | str) -> Path:
    """Where this user's page of the daemon at `address` is told, beside the usual place of sockets."""
    where = parse(address)
    named = os.path.abspath(where.path) if where.path else f"{where.host}:{where.port}"
    digest = hashlib.sha256(named.encode()).hexdigest()[:12]
    return default_socket_path().parent / f"page-{digest}"


def told(address: Path | str) -> str:
    """Where operators find the page of the daemon at `address`; empty when nothing is told of it."""
    found = told_links(address)
    return found.operator if found else ""


def told_links(address: Path | str) -> Links | None:
    """Both addresses of that page; None when there is none, or it is not ours to know."""
    with suppress(OSError, UnicodeDecodeError):
        match page_file(address).read_text(encoding="ascii").split():
            case [operator, observer]:
                return Links(operator, observer)
    return None


@contextmanager
def announced(address: Path | str, page: Links) -> Iterator[None]:
    """While entered, the file says where the page is; where there can be none, nothing is said."""
    file = page_file(address)
    with suppress(OSError):
        file.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
        with replacing(file, mode=_PRIVATE) as out:
            out.write(f"{page.operator}\n{page.observer}\n".encode())
    try:
        yield
    finally:
        if told_links(address) == page:
            with suppress(OSError):
                file.unlink()
