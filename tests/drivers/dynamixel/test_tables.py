import itertools
import math

import pytest

from drivers.dynamixel import firmware1, firmware2
from drivers.dynamixel.firmware1 import ERRORS, REFUSED
from drivers.dynamixel.registers import Register, Signed
from drivers.dynamixel.tables import KNOWN_NUMBERS, MODELS

MX_28 = firmware1.MX_28


@pytest.mark.parametrize("model", MODELS)
def test_no_two_registers_overlap(model: str) -> None:
    registers = sorted(MODELS[model].table.values(), key=lambda register: register.address)
    for before, after in itertools.pairwise(registers):
        assert before.end <= after.address


@pytest.mark.parametrize("model", MODELS)
def test_every_register_has_a_size_that_its_sign_fits_in(model: str) -> None:
    for register in MODELS[model].table.values():
        assert register.size in (1, 2, 4)
        assert register.size > 1 or register.signed is Signed.NO
        assert register.per_lsb > 0


@pytest.mark.parametrize("table", [MX_28, firmware2._SHARED])
def test_the_registers_of_the_first_model_stand_in_the_order_of_the_manual(
    table: dict[str, Register],
) -> None:
    addresses = [register.address for register in table.values()]
    assert addresses == sorted(addresses)


def test_later_models_have_everything_that_earlier_ones_have() -> None:
    tables = [MODELS[name].table for name in ("MX-28", "MX-64", "MX-106")]
    for earlier, later in itertools.pairwise(tables):
        assert earlier.items() <= later.items()


def test_an_ax_differs_from_an_mx_in_what_its_page_of_the_manual_says() -> None:
    ax = MODELS["AX-12A"].table
    assert {name for name in ax if name not in MX_28} == {
        "CW Compliance Margin", "CCW Compliance Margin", "CW Compliance Slope", "CCW Compliance Slope",
    }  # fmt: skip
    assert all(ax[name].address == MX_28[name].address for name in ax if name in MX_28)


@pytest.mark.parametrize("model", MODELS)
def test_a_goal_is_written_as_one_and_lies_in_no_window(model: str) -> None:
    table, layout = MODELS[model].table, MODELS[model].layout
    first, second = (table[name] for name in layout.goal)
    assert first.end == second.address
    assert layout.speed in layout.goal


@pytest.mark.parametrize("model", MODELS)
def test_every_window_holds_the_first_is_longer_than_the_last_and_has_no_gap(model: str) -> None:
    table, layout = MODELS[model].table, MODELS[model].layout
    first = layout.windows[0]
    sizes = [window.size for window in layout.windows]
    assert sizes == sorted(set(sizes))
    known = {address for register in table.values() for address in range(register.address, register.end)}
    known |= {29} if layout.protocol == 1 else set()  # protocol 1.0 reads across what is not defined
    for window in layout.windows:
        assert window.address <= first.address
        assert first.end <= window.end
        assert set(range(window.address, window.end)) <= known


def test_model_numbers_are_those_of_the_manual() -> None:
    assert {name: model.number for name, model in MODELS.items()} == {
        "AX-12A": 12,
        "MX-28": 29,
        "MX-64": 310,
        "MX-106": 320,
        "MX-28(2.0)": 30,
        "MX-64(2.0)": 311,
        "MX-106(2.0)": 321,
    }
    assert KNOWN_NUMBERS[12] == "an AX-12A"
    assert KNOWN_NUMBERS[311] == "an MX-64 with firmware for protocol 2.0"


def test_steps_are_those_of_the_manual() -> None:
    assert math.degrees(MX_28["Goal Position"].per_lsb) == pytest.approx(0.088, abs=2e-4)
    assert math.degrees(MX_28["Moving Speed"].per_lsb) == pytest.approx(0.684)
    assert math.degrees(254 * MX_28["Goal Acceleration"].per_lsb) == pytest.approx(2180, abs=1)
    assert 250 * MX_28["Return Delay Time"].per_lsb == pytest.approx(500e-6)
    assert math.degrees(firmware1.AX_12A["Goal Position"].per_lsb) == pytest.approx(0.293, abs=1e-3)
    assert math.degrees(firmware2.MX_28["Profile Velocity"].per_lsb) == pytest.approx(1.374)
    assert firmware2.MX_28["BUS Watchdog"].per_lsb == 0.02


def test_conditions_of_the_servo_are_not_refusals() -> None:
    refusals = [name for bit, name in enumerate(ERRORS) if REFUSED >> bit & 1]
    assert refusals == ["Angle Limit Error", "Range Error", "Checksum Error", "Instruction Error"]
