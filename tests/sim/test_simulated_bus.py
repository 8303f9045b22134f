"""Bytes are spelled out, or come from the manual: no codec takes part but the one under test."""

import math
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim.dynamixel import tables1 as tables
from sim.dynamixel.bus import Bus
from sim.dynamixel.cells import Cell, Table
from sim.dynamixel.device import Device
from sim.dynamixel.models import TABLES, build_device
from sim.dynamixel.packets1 import Parser
from sim.servo import Servo
from sim.servo_models import SERVO_MODELS
from sim.shaft import Link

TURNAROUND = 50e-6

ROM = {tables.BAUD: 1, tables.RETURN_DELAY: 0}
BYTE = 10e-6


def device(servo: int = 1, model: str = "MX-28", rom: dict[Cell, int] | None = None) -> Device:
    return build_device(Servo(SERVO_MODELS[model], Link()), {**ROM, tables.ID: servo, **(rom or {})})


def a_bus(*devices: Device) -> Bus:
    return Bus(devices or (device(1), device(2, "MX-106")))


def packet(servo: int, *body: int) -> bytes:
    inner = bytes((servo, len(body) + 1, *body))
    return b"\xff\xff" + inner + bytes((~sum(inner) & 0xFF,))


def replies(bus: Bus, data: bytes) -> list[bytes]:
    return [reply for _, reply in bus.feed(data)]


def error(bus: Bus, data: bytes) -> int:
    (reply,) = replies(bus, data)
    return reply[4]


def advance(bus: Bus, seconds: float) -> None:
    for unit in bus.devices:
        for _ in range(round(seconds * 1000)):
            unit.servo.step(0.001)


def word(value: int) -> tuple[int, int]:
    return value % 256, value // 256


def test_the_manuals_ping_is_answered() -> None:
    assert replies(a_bus(), bytes.fromhex("FF FF 01 02 01 FB")) == [bytes.fromhex("FF FF 01 02 00 FC")]


def test_the_manuals_read_of_the_temperature_is_answered() -> None:
    request = bytes.fromhex("FF FF 01 04 02 2B 01 CC")
    bus = a_bus()
    bus.devices[0].servo.temperature = 32.0
    assert replies(bus, request) == [bytes.fromhex("FF FF 01 03 00 20 DB")]


def test_a_reading_shows_position_speed_load_voltage_and_temperature() -> None:
    bus = a_bus(device(1))
    servo = bus.devices[0].servo
    servo.position, servo.velocity, servo.duty = math.pi / 2, -0.5, -0.25
    (reply,) = replies(bus, bytes.fromhex("FF FF 01 04 02 24 08 CC"))
    assert reply[5:-1] == bytes((*word(3072), *word(1024 + 42), *word(1024 + 256), 120, 25))


def test_a_model_tells_its_number_and_firmware() -> None:
    bus = a_bus(device(1), device(2, "MX-64"), device(3, "MX-106"))
    found = [replies(bus, packet(servo, 2, 0, 3))[0][5:8] for servo in (1, 2, 3)]
    assert found == [bytes((29, 0, 41)), bytes((54, 1, 41)), bytes((64, 1, 41))]


def test_a_goal_turns_torque_on_and_moves_the_servo() -> None:
    bus = a_bus(device(1))
    assert error(bus, packet(1, 3, 30, *word(2148), *word(67))) == 0
    advance(bus, 1.0)
    assert bus.devices[0].get(tables.TORQUE_ENABLE) == 1
    assert bus.devices[0].servo.sense().ticks == pytest.approx(2148, abs=5)


def test_a_speed_alone_leaves_torque_off() -> None:
    bus = a_bus(device(1))
    assert error(bus, packet(1, 3, 32, *word(67))) == 0
    assert bus.devices[0].get(tables.TORQUE_ENABLE) == 0


def test_a_sync_write_reaches_all_and_nobody_answers() -> None:
    bus = a_bus()
    request = bytes.fromhex("FF FF FE 0E 83 1E 04 01 00 08 43 00 02 F8 06 2D 00 D5")
    assert replies(bus, request) == []
    assert [(d.get(tables.GOAL), d.get(tables.MOVING_SPEED)) for d in bus.devices] == [(2048, 67), (1784, 45)]


def test_a_bulk_read_is_answered_in_turn() -> None:
    bus = a_bus()
    found = replies(bus, bytes.fromhex("FF FF FE 09 92 00 0A 01 22 0A 02 22 0B"))
    assert [(reply[2], len(reply)) for reply in found] == [(1, 16), (2, 16)]


@pytest.mark.parametrize(("silent", "heard"), [(0, []), (1, [1]), (2, [1, 2])])
def test_a_bulk_read_ends_at_the_first_silent_servo(silent: int, heard: list[int]) -> None:
    bus = a_bus(device(1), device(2), device(3))
    bus.devices[silent].servo.silent = True
    request = packet(254, 0x92, 0, *(10, 1, 34), *(10, 2, 34), *(10, 3, 34))
    assert [reply[2] for reply in replies(bus, request)] == heard


def test_a_registered_write_waits_for_the_action() -> None:
    bus = a_bus(device(1))
    assert error(bus, packet(1, 4, 30, *word(2148))) == 0
    assert (bus.devices[0].get(tables.GOAL), bus.devices[0].get(tables.REGISTERED)) == (2048, 1)
    assert replies(bus, packet(254, 5)) == []
    assert (bus.devices[0].get(tables.GOAL), bus.devices[0].get(tables.REGISTERED)) == (2148, 0)


def test_an_action_without_a_registered_write_is_an_instruction_error() -> None:
    assert error(a_bus(), packet(1, 5)) == 64


@pytest.mark.parametrize(
    ("request_", "bit"),
    [
        (packet(1, 0x55), 64),  # no such instruction
        (packet(1, 2, 36), 64),  # a read without a length
        (packet(1, 2, 70, 10), 8),  # beyond the table
        (packet(1, 3, 25, 2), 8),  # LED is 0 or 1
        (packet(1, 3, 36, 0, 0), 8),  # the present position is read only
        (packet(1, 3, 31, 16), 8),  # one byte is enough to make a goal of 4096
        (b"\xff\xff\x01\x02\x01\xfa", 16),  # its checksum is FB
    ],
)
def test_mistakes_are_named_by_their_bit(request_: bytes, bit: int) -> None:
    assert error(a_bus(), request_) == bit


def test_a_goal_outside_the_angle_limits_is_refused() -> None:
    bus = a_bus(device(1, rom={tables.CCW_LIMIT: 3000}))
    assert error(bus, packet(1, 3, 30, *word(3001))) == 2
    assert bus.devices[0].get(tables.GOAL) == 2048
    assert bus.devices[0].get(tables.TORQUE_ENABLE) == 0


def test_the_eeprom_is_locked_while_torque_is_on() -> None:
    bus = a_bus(device(1))
    assert error(bus, packet(1, 3, 24, 1)) == 0
    assert error(bus, packet(1, 3, 5, 10)) == 8
    assert error(bus, packet(1, 3, 24, 0)) == 0
    assert error(bus, packet(1, 3, 5, 10)) == 0
    assert bus.devices[0].get(tables.RETURN_DELAY) == 10


def test_a_write_to_the_eeprom_takes_its_time() -> None:
    bus = a_bus(device(1))
    ((delay, _),) = bus.feed(packet(1, 3, 8, *word(3000)))
    assert delay > 2 * 0.006


@pytest.mark.parametrize(("level", "answers"), [(0, [1, 0, 0]), (1, [1, 1, 0]), (2, [1, 1, 1])])
def test_the_status_return_level_says_what_is_answered(level: int, answers: list[int]) -> None:
    bus = a_bus(device(1))
    replies(bus, packet(1, 3, 16, level))
    requests = (packet(1, 1), packet(1, 2, 36, 2), packet(1, 3, 25, 1))
    assert [len(replies(bus, request)) for request in requests] == answers


@pytest.mark.parametrize("request_", [packet(254, 1), packet(254, 2, 36, 2), packet(254, 3, 25, 1)])
def test_nobody_answers_a_broadcast(request_: bytes) -> None:
    assert replies(a_bus(), request_) == []


def test_a_broadcast_write_reaches_all() -> None:
    bus = a_bus()
    replies(bus, packet(254, 3, 25, 1))
    assert all(unit.read(25, 1)[1] == b"\x01" for unit in bus.devices)


def test_a_reply_takes_wire_time_turnaround_and_return_delay() -> None:
    bus = a_bus(device(1))
    replies(bus, packet(1, 3, 5, 250))
    ((delay, reply),) = bus.feed(packet(1, 2, 36, 8))
    assert delay == pytest.approx(8 * BYTE + 500e-6 + TURNAROUND + len(reply) * BYTE)


def test_a_bulk_read_of_five_takes_one_and_a_half_milliseconds() -> None:
    bus = a_bus(*(device(servo) for servo in range(1, 6)))
    request = packet(254, 0x92, 0, *(n for servo in range(1, 6) for n in (10, servo, 34)))
    assert bus.feed(request)[-1][0] == pytest.approx(0.0013, abs=0.0003)


def test_without_timing_replies_come_at_once() -> None:
    bus = Bus([device(1)], timing=False)
    assert [delay for delay, _ in bus.feed(packet(1, 1))] == [0.0]


@pytest.mark.parametrize(
    ("register", "host", "heard"),
    [(1, 1_000_000, 1), (1, 57_600, 0), (34, 57_600, 1), (34, 1_000_000, 0), (252, 3_000_000, 1)],
)
def test_a_servo_hears_only_its_own_baud_rate(register: int, host: int, heard: int) -> None:
    unit = device(1, rom={tables.BAUD: register})
    assert len(replies(Bus([unit], baud=host), packet(1, 1))) == heard


def test_the_default_baud_rate_is_the_manuals() -> None:
    assert tables.RATES[34] == 57_142


def test_two_servos_with_one_id_garble_each_other() -> None:
    bus = a_bus(device(1), device(1, "MX-64"))
    (garbled,) = replies(bus, packet(1, 2, 0, 3))
    assert garbled[-1] != ~sum(garbled[2:-1]) & 0xFF


def test_an_overload_zeroes_the_torque_limit_until_it_is_written() -> None:
    bus = a_bus(device(1))
    bus.devices[0].servo.trip("overload")
    (reply,) = replies(bus, packet(1, 2, 34, 2))
    assert (reply[4], reply[5:7]) == (32, b"\x00\x00")
    assert error(bus, packet(1, 3, 34, *word(1023))) == 0
    assert replies(bus, packet(1, 2, 34, 2))[0][5:7] == bytes(word(1023))


def test_an_overload_that_is_lifted_gives_the_torque_limit_back() -> None:
    bus = a_bus(device(1))
    bus.devices[0].servo.trip("overload")
    replies(bus, packet(1, 2, 34, 2))
    bus.devices[0].servo.restore()
    assert replies(bus, packet(1, 2, 34, 2))[0][5:7] == bytes(word(1023))


def test_a_power_cut_resets_what_is_not_eeprom() -> None:
    bus = a_bus(device(1))
    replies(bus, packet(1, 3, 5, 10) + packet(1, 3, 30, *word(2148)))
    bus.devices[0].servo.power(False)
    assert replies(bus, packet(1, 1)) == []
    bus.devices[0].servo.power(True)
    assert replies(bus, packet(1, 1)) == []
    advance(bus, 0.31)
    (reply,) = replies(bus, packet(1, 2, 5, 1))
    assert reply[5] == 10
    (reply,) = replies(bus, packet(1, 2, 24, 1))
    assert reply[5] == 0


def test_a_factory_reset_is_confirmed_and_then_the_servo_is_as_new() -> None:
    bus = a_bus(device(7))
    assert error(bus, packet(7, 6)) == 0
    advance(bus, 0.31)
    bus.baud = 57_142
    (reply,) = replies(bus, packet(1, 2, 5, 1))
    assert reply[5] == 250


def test_an_ax_has_1024_counts_over_300_degrees() -> None:
    bus = a_bus(device(1, "AX-12A"))
    bus.devices[0].servo.position = math.radians(-150)
    (reply,) = replies(bus, packet(1, 2, 36, 2))
    assert reply[5:7] == bytes(word(0))
    assert error(bus, packet(1, 3, 30, *word(1024))) == 8
    assert error(bus, packet(1, 3, 30, *word(512))) == 0
    advance(bus, 5.0)
    assert bus.devices[0].servo.position == pytest.approx(0.0, abs=math.radians(1))


def test_an_ax_follows_a_speed_and_is_armed_by_it() -> None:
    bus = a_bus(device(1, "AX-12A"))
    replies(bus, packet(1, 3, 32, *word(100)))
    assert bus.devices[0].get(tables.TORQUE_ENABLE) == 1
    replies(bus, packet(1, 3, 30, *word(900)))
    advance(bus, 1.0)
    before = bus.devices[0].servo.position
    advance(bus, 0.5)
    assert bus.devices[0].servo.position - before == pytest.approx(0.5 * math.radians(66.6), rel=0.05)


def test_an_ax_takes_no_part_in_a_bulk_read() -> None:
    bus = a_bus(device(1), device(2, "AX-12A"), device(3))
    request = packet(254, 0x92, 0, *(10, 1, 34), *(10, 2, 34), *(10, 3, 34))
    assert [reply[2] for reply in replies(bus, request)] == [1]
    assert len(replies(bus, packet(2, 2, 34, 10))) == 1


def test_an_ax_has_no_register_beyond_its_punch() -> None:
    assert error(a_bus(device(1, "AX-12A")), packet(1, 2, 50, 2)) == 8


def test_a_request_in_pieces_is_one_request() -> None:
    bus = a_bus()
    request = packet(1, 2, 36, 8)
    assert [len(replies(bus, bytes((byte,)))) for byte in request] == [0] * (len(request) - 1) + [1]


def test_a_packet_that_was_begun_can_be_forgotten() -> None:
    bus = a_bus()
    assert replies(bus, packet(1, 2, 36, 8)[:5]) == []
    bus.forget()
    assert len(replies(bus, packet(1, 1))) == 1


def test_garbage_before_a_packet_is_skipped() -> None:
    assert len(replies(a_bus(), b"\x00\xff\xff\xff" + packet(1, 1))) == 1


@given(st.lists(st.binary(max_size=64), max_size=8))
def test_random_bytes_never_raise_and_are_not_hoarded(chunks: list[bytes]) -> None:
    bus = a_bus()
    for chunk in chunks:
        bus.feed(chunk)
    bus.forget()
    bus.baud = 1_000_000
    for unit in bus.devices:
        unit.write(tables.ID.address, b"\x09")
    assert len(replies(bus, packet(9, 1))) <= 1


INSTRUCTIONS = st.sampled_from([1, 2, 3, 4, 5, 6, 0x83, 0x92]) | st.integers(0, 255)


@given(st.sampled_from([0, 1, 2, 254]), INSTRUCTIONS, st.binary(max_size=30))
def test_sound_packets_with_random_contents_never_raise(servo: int, code: int, parameters: bytes) -> None:
    bus = a_bus()
    bus.feed(packet(servo, code, *parameters))
    advance(bus, 0.005)
    bus.feed(packet(1, 2, 0, 74))


@given(st.binary(max_size=200), st.lists(st.integers(0, 200), max_size=6))
def test_where_the_bytes_are_cut_makes_no_difference(data: bytes, cuts: list[int]) -> None:
    data += packet(1, 1)
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    whole, pieces = Parser(), Parser()
    in_pieces = [r for a, b in pairwise(edges) for r in pieces.feed(data[a:b])]
    found = [(r.servo, r.instruction, r.parameters, r.sound) for r in whole.feed(data)]
    assert [(r.servo, r.instruction, r.parameters, r.sound) for r in in_pieces] == found


@pytest.mark.parametrize("table", TABLES.values(), ids=lambda table: table.name)
def test_registers_do_not_overlap_and_hold_their_values(table: Table) -> None:
    taken = [address for cell in table.cells for address in range(cell.address, cell.address + cell.size)]
    assert len(taken) == len(set(taken))
    assert max(taken) < table.size
    assert all(max(c.initial, c.high) < 256**c.size // (2 if c.signed else 1) for c in table.cells)
    assert all(c.low <= c.initial <= c.high for c in table.cells if c.writable)


def test_a_cell_without_a_range_is_read_only() -> None:
    assert not Cell(36, 2, 0).writable
