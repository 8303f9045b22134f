"""What runs with the daemon may be used by everybody for everything."""

import re
from collections.abc import Iterator
from importlib.metadata import Distribution, distribution

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

PERMISSIVE = {
    "0bsd", "apache-2.0", "bsd", "bsd-2-clause", "bsd-3-clause", "cc0-1.0", "isc", "mit", "psf-2.0", "zlib",
}  # fmt: skip

WORDS = {
    "apache 2.0": "apache-2.0",
    "mit license": "mit",
    "bsd license": "bsd",
    "3-clause bsd license": "bsd-3-clause",
}
"""How older packages call them."""

EXCUSED = {
    "python-can": "LGPL-3.0-only: a package of its own, unchanged, and imported by nothing but drivers.can",
}


def runtime(name: str, seen: set[str] | None = None) -> Iterator[Distribution]:
    """Every distribution that comes with `name`, at any remove."""
    seen = set() if seen is None else seen
    for line in distribution(name).requires or []:
        wanted = Requirement(line)
        key = canonicalize_name(wanted.name)
        if key in seen or (wanted.marker and not wanted.marker.evaluate({"extra": ""})):
            continue
        seen.add(key)
        yield distribution(key)
        yield from runtime(key, seen)


def licences(found: Distribution) -> set[str]:
    """What a distribution says of itself, all of it at once; of "A OR B" the better."""
    told = found.metadata.json
    texts = [told.get("license_expression"), told.get("license")] + [
        entry.rpartition(" :: ")[2] for entry in told.get("classifier", []) if entry.startswith("License")
    ]
    said = next((str(text) for text in texts if text), "")
    return {chosen(part) for part in re.split(r"\s+AND\s+", said.strip("()"))}


def chosen(expression: str) -> str:
    """The one of "A OR B" that is permissive, or the whole."""
    names = [WORDS.get(name.lower(), name.lower()) for name in expression.strip("() ").split(" OR ")]
    return next((name for name in names if name in PERMISSIVE), expression)


def test_everything_that_the_daemon_needs_has_a_permissive_licence() -> None:
    named = {canonicalize_name(found.name): licences(found) for found in runtime("bentod")}
    assert {"numpy", "pydantic-core", "msgpack"} <= set(named)
    wrong = {name: said - PERMISSIVE for name, said in named.items() if said - PERMISSIVE}
    assert set(wrong) == set(EXCUSED), wrong


@pytest.mark.parametrize(
    ("expression", "name"),
    [("MIT", "mit"), ("GPL-3.0-only OR MIT", "mit"), ("GPL-3.0-only", "GPL-3.0-only"), ("", "")],
)
def test_a_licence_that_leaves_a_choice_is_taken_at_its_best(expression: str, name: str) -> None:
    assert chosen(expression) == name
