"""The built page, read once: what is served is what was there when the server began."""

import gzip
import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from bentod.errors import ConfigError

STATIC = Path(__file__).parent / "static"
"""The page as `make page` builds it."""

_TYPES = {
    ".html": "text/html; charset=utf-8",
    ".js": "text/javascript; charset=utf-8",
    ".css": "text/css; charset=utf-8",
    ".svg": "image/svg+xml",
    ".txt": "text/plain; charset=utf-8",
    ".urdf": "application/xml; charset=utf-8",
    ".webmanifest": "application/manifest+json",
}
"""Nothing else is served."""


@dataclass(frozen=True, slots=True)
class Asset:
    """One file."""

    body: bytes
    zipped: bytes  # gzip
    kind: str  # media type
    tag: str  # entity tag: changes with the content


def read_assets(folder: Path = STATIC, urdf: Path | None = None) -> Mapping[str, Asset]:
    """Every file to be served, by its path in URLs. `urdf`: shown instead of the Bento Arm.

    Raises:
        ConfigError: there is no page, or a file cannot be read.
    """
    try:
        files = {f"/{path.relative_to(folder).as_posix()}": path for path in folder.rglob("*")}
        shown = urdf or files.get("/models/bento.urdf")
        if shown:
            files["/models/arm.urdf"] = shown
        found = {url: _asset(path) for url, path in sorted(files.items()) if path.suffix in _TYPES}
    except OSError as error:
        raise ConfigError(f"{error.filename} cannot be read: {error.strerror}.") from error
    if "/index.html" not in found:
        raise ConfigError(f"There is no page in {folder}: build it with make page.")
    found["/"] = found["/index.html"]
    return found


def build_of(assets: Mapping[str, Asset]) -> str:
    """A word that changes whenever any file does."""
    tags = "".join(f"{url} {asset.tag}\n" for url, asset in sorted(assets.items()))
    return hashlib.sha256(tags.encode()).hexdigest()[:16]


def _asset(path: Path) -> Asset:
    body = path.read_bytes()
    tag = hashlib.sha256(body).hexdigest()[:16]
    return Asset(body, gzip.compress(body, 6, mtime=0), _TYPES[path.suffix], f'"{tag}"')
