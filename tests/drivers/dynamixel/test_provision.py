import click
import pytest

from bentod.errors import BusError, Refused
from drivers.dynamixel.ids import parse_ids
from drivers.dynamixel.provision.rates import same_rate, to_register, usual
from drivers.dynamixel.provision.sdk import Line
from drivers.dynamixel.tables import MODELS

CONTEXT = click.Context(click.Command("x"))
PARAMETER = click.Option(["--ids"])


@pytest.mark.parametrize(
    ("model", "baud", "value"),
    [
        ("MX-28", 1_000_000, 1),
        ("MX-28", 57_142, 34),
        ("MX-28", 57_600, 34),
        ("MX-28", 115_200, 16),
        ("MX-106", 3_000_000, 252),
        ("MX-106", 2_250_000, 250),
        ("AX-12A", 1_000_000, 1),
        ("MX-28(2.0)", 57_600, 1),
        ("MX-28(2.0)", 1_000_000, 3),
        ("MX-28(2.0)", 4_500_000, 7),
    ],
)
def test_a_rate_is_the_manuals_number(model: str, baud: int, value: int) -> None:
    assert to_register(MODELS[model], baud) == value


@pytest.mark.parametrize(
    ("model", "baud"), [("MX-28", 700_000), ("AX-12A", 3_000_000), ("MX-28(2.0)", 500_000)]
)
def test_a_rate_that_a_servo_has_not_is_refused_with_the_nearest(model: str, baud: int) -> None:
    with pytest.raises(Refused, match=f"There is no rate of {baud} bit/s; the nearest is"):
        to_register(MODELS[model], baud)


def test_a_port_is_opened_at_the_usual_rate_beside_a_servos_odd_one() -> None:
    assert usual(57_142) == 57_600
    assert usual(117_647) == 115_200
    assert usual(2_250_000) == 2_250_000
    assert same_rate(57_142, 57_600)


@pytest.mark.parametrize(
    ("text", "ids"), [("3", (3,)), ("1-3, 2,9", (1, 2, 3, 9)), ("0-252", tuple(range(253)))]
)
def test_ids_are_typed_as_people_do(text: str, ids: tuple[int, ...]) -> None:
    assert parse_ids(CONTEXT, PARAMETER, text) == ids


@pytest.mark.parametrize("text", ["", "x", "3-1", "253", "1-254", "-1", "1,,2"])
def test_what_is_no_id_is_refused(text: str) -> None:
    with pytest.raises(click.BadParameter, match="between 0 and 252"):
        parse_ids(CONTEXT, PARAMETER, text)


def test_a_port_that_is_not_there_is_said_to_be_missing() -> None:
    with pytest.raises(BusError, match="there is no such port"):
        Line("/dev/there-is-no-such-port", 1_000_000, 1)
