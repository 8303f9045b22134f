import itertools
import math

import pytest

from drivers.dynamixel.tables import ERRORS, KNOWN_NUMBERS, MODELS, MX_28, REFUSED, Signed


@pytest.mark.parametrize("model", MODELS)
def test_no_two_registers_overlap(model: str) -> None:
    registers = sorted(MODELS[model].table.values(), key=lambda register: register.address)
    for before, after in itertools.pairwise(registers):
        assert before.end <= after.address


@pytest.mark.parametrize("model", MODELS)
def test_every_register_has_a_size_that_its_sign_fits_in(model: str) -> None:
    for register in MODELS[model].table.values():
        assert register.size in (1, 2)
        assert register.size == 2 or register.signed is Signed.NO
        assert register.per_lsb > 0


def test_the_registers_of_the_first_model_stand_in_the_order_of_the_manual() -> None:
    addresses = [register.address for register in MX_28.values()]
    assert addresses == sorted(addresses)


def test_later_models_have_everything_that_earlier_ones_have() -> None:
    tables = [model.table for model in MODELS.values()]
    for earlier, later in itertools.pairwise(tables):
        assert earlier.items() <= later.items()


def test_goal_and_speed_are_neighbours_and_so_is_everything_that_a_round_reads() -> None:
    goal = ["Goal Position", "Moving Speed"]
    window = [
        "Torque Limit", "Present Position", "Present Speed",
        "Present Load", "Present Voltage", "Present Temperature",
    ]  # fmt: skip
    for names in (goal, window):
        for before, after in itertools.pairwise(names):
            assert MX_28[before].end == MX_28[after].address


def test_model_numbers_are_those_of_firmware_for_protocol_1() -> None:
    assert {name: model.number for name, model in MODELS.items()} == {
        "MX-28": 29,
        "MX-64": 310,
        "MX-106": 320,
    }
    assert all(model.number in KNOWN_NUMBERS for model in MODELS.values())


def test_steps_are_those_of_the_manual() -> None:
    assert math.degrees(MX_28["Goal Position"].per_lsb) == pytest.approx(0.088, abs=2e-4)
    assert math.degrees(MX_28["Moving Speed"].per_lsb) == pytest.approx(0.684)
    assert math.degrees(254 * MX_28["Goal Acceleration"].per_lsb) == pytest.approx(2180, abs=1)
    assert 250 * MX_28["Return Delay Time"].per_lsb == pytest.approx(500e-6)


def test_conditions_of_the_servo_are_not_refusals() -> None:
    refusals = [name for bit, name in enumerate(ERRORS) if REFUSED >> bit & 1]
    assert refusals == ["Angle Limit Error", "Range Error", "Checksum Error", "Instruction Error"]
