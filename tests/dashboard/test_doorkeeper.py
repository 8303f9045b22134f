"""Who may come in."""

import pytest

from bentod.dashboard.doorkeeper import Doorkeeper, Tokens
from bentod.dashboard.place import Place
from bentod.errors import ConfigError


@pytest.mark.parametrize("host", ["127.0.0.1:8780", "localhost:8780", "[::1]:8780", "LocalHost:8780"])
def test_this_machine_is_known_by_its_names(host: str) -> None:
    assert Doorkeeper(["127.0.0.1"], 8780, tls=False).knows(host)


@pytest.mark.parametrize(
    "host",
    ["evil.example:8780", "127.0.0.1", "127.0.0.1:80", "127.0.0.1.evil.example:8780", "", "a:b:c", "[::1"],
)
def test_a_name_that_somebody_else_points_here_is_not(host: str) -> None:
    assert not Doorkeeper(["127.0.0.1"], 8780, tls=False).knows(host)


@pytest.mark.parametrize(
    "origin",
    [
        "",
        "null",
        "http://evil.example",
        "https://127.0.0.1:8780",
        "http://127.0.0.1:9999",
        "http://localhost:8780",
    ],
)
def test_only_a_page_of_this_server_may_speak(origin: str) -> None:
    door = Doorkeeper(["127.0.0.1"], 8780, tls=False)
    assert not door.is_own(origin, "127.0.0.1:8780")
    assert door.is_own("http://127.0.0.1:8780", "127.0.0.1:8780")


def test_a_token_makes_an_operator_or_an_observer_or_nobody() -> None:
    tokens = Tokens.new()
    assert tokens.role(tokens.operator) == "operator"
    assert tokens.role(tokens.observer) == "observer"
    assert {tokens.role(other) for other in ("", "ü", tokens.operator[:-1], "x" * 10_000)} == {""}
    assert len({tokens.operator, tokens.observer, Tokens.new().operator}) == 3


def test_other_machines_are_served_over_tls_only() -> None:
    with pytest.raises(ConfigError, match="needs TLS"):
        Place("lab.example", 8780).checked()
    assert Place("127.0.0.1", 8780).checked() is None
