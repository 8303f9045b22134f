"""The page that is kept is built from the sources that are kept, small, and knows no other server."""

import hashlib
import json
import re
from pathlib import Path

import bentod.dashboard
from bentod.dashboard.assets import STATIC, read_assets

PAGE = Path(bentod.dashboard.__path__[0], "page")
SOURCES = ("index.html", "package.json", "package-lock.json", "build.mjs", "src", "models")
GREATEST = 800_000
"""Bytes of everything that a browser loads."""


def fingerprint() -> str:
    """One word for all sources, as build.mjs computes it too."""
    found = [
        path
        for name in SOURCES
        for path in ((PAGE / name).rglob("*") if (PAGE / name).is_dir() else [PAGE / name])
    ]
    whole = hashlib.sha256()
    for path in sorted(map(str, filter(Path.is_file, found))):
        digest = hashlib.sha256(Path(path).read_bytes()).hexdigest()
        whole.update(f"{path[len(str(PAGE)) + 1 :]} {digest}\n".encode())
    return whole.hexdigest()


def test_the_page_is_built_from_these_sources() -> None:
    assert (STATIC / "sources.sha256").read_text().strip() == fingerprint(), "make page builds it"


def test_the_page_is_small() -> None:
    loaded = [asset.body for url, asset in read_assets().items() if url not in ("/", "/licences.txt")]
    assert sum(map(len, loaded)) < GREATEST


def test_no_file_names_where_packages_come_from() -> None:
    lock = json.loads((PAGE / "package-lock.json").read_text())
    assert all("integrity" in entry for name, entry in lock["packages"].items() if name)
    for path in (PAGE / "package.json", PAGE / "package-lock.json", PAGE / ".npmrc", PAGE / "build.mjs"):
        assert not re.search(r"https?://(?!.*(funding|sponsor))", path.read_text()), path


def test_every_version_is_pinned() -> None:
    about = json.loads((PAGE / "package.json").read_text())
    pinned = {**about["dependencies"], **about["devDependencies"]}
    assert all(re.fullmatch(r"\d+\.\d+\.\d+", version) for version in pinned.values())


def test_licences_of_all_that_is_shipped_go_along() -> None:
    about = json.loads((PAGE / "package.json").read_text())
    told = (STATIC / "licences.txt").read_text()
    assert all(f"{name} {version}" in told for name, version in about["dependencies"].items())
