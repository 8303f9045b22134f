"""Protocol 2.0: bytes are spelled out, and the only CRC that is trusted is the servo maker's."""

import math
from itertools import pairwise

import pytest
from dynamixel_sdk import Protocol2PacketHandler
from hypothesis import given
from hypothesis import strategies as st

from sim.dynamixel import packets1, packets2, tables1, tables2
from sim.dynamixel.bus import Bus
from sim.dynamixel.cells import Cell
from sim.dynamixel.device import Device
from sim.dynamixel.models import build_device
from sim.dynamixel.packets2 import Parser, crc
from sim.servo import Servo
from sim.servo_models import MX2_SCALE, SERVO_MODELS
from sim.shaft import Link

SDK = Protocol2PacketHandler()
TORQUE, GOAL, PROFILE, WATCHDOG, HARDWARE_ERROR = 64, 116, 112, 98, 70
BYTE = 10e-6


def device(servo: int = 1, model: str = "MX-28(2.0)", rom: dict[Cell, int] | None = None) -> Device:
    provisioned = {tables2.ID: servo, tables2.BAUD: 3, tables2.RETURN_DELAY: 0}
    return build_device(Servo(SERVO_MODELS[model], Link()), {**provisioned, **(rom or {})})


def old_device(servo: int) -> Device:
    provisioned = {tables1.ID: servo, tables1.BAUD: 1, tables1.RETURN_DELAY: 0}
    return build_device(Servo(SERVO_MODELS["MX-28"], Link()), provisioned)


def a_bus(*devices: Device) -> Bus:
    return Bus(devices or (device(1), device(2, "MX-106(2.0)")))


def sealed(body: bytes) -> bytes:
    return body + little(int(SDK.updateCRC(0, body, len(body))), 2)


def packet(servo: int, *body: int) -> bytes:
    """A request whose parameters need no stuffing."""
    return sealed(bytes((255, 255, 253, 0, servo, *little(len(body) + 2, 2), *body)))


def little(value: int, size: int) -> bytes:
    return value.to_bytes(size, "little", signed=value < 0)


def write(servo: int, address: int, value: int, size: int = 1) -> bytes:
    return packet(servo, 3, *little(address, 2), *little(value, size))


def read(servo: int, address: int, size: int) -> bytes:
    return packet(servo, 2, *little(address, 2), *little(size, 2))


def replies(bus: Bus, data: bytes) -> list[bytes]:
    found = [reply for _, reply in bus.feed(data)]
    assert all(reply == sealed(reply[:-2]) for reply in found)
    return found


def error(bus: Bus, data: bytes) -> int:
    (reply,) = replies(bus, data)
    return reply[8]


def value(bus: Bus, servo: int, address: int, size: int) -> int:
    (reply,) = replies(bus, read(servo, address, size))
    return int.from_bytes(reply[9:-2], "little", signed=True)


def advance(bus: Bus, seconds: float) -> None:
    for unit in bus.devices:
        unit.servo.run(round(seconds * 1000), 0.001)


def holding(bus: Bus, servo: int = 1) -> Bus:
    assert error(bus, write(servo, TORQUE, 1)) == 0
    return bus


def test_the_manuals_ping_is_answered() -> None:
    request = bytes.fromhex("FF FF FD 00 01 03 00 01 19 4E")
    (reply,) = replies(a_bus(), request)
    assert reply[:-2] == bytes.fromhex("FF FF FD 00 01 07 00 55 00 1E 00 2B")


def test_the_manuals_ping_reply_is_what_a_servo_of_that_model_would_say() -> None:
    """The manual's example is an XM430-W210 with firmware 38."""
    assert packets2.status(1, 0, bytes.fromhex("06 04 26")) == bytes.fromhex(
        "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D"
    )


@given(st.binary(max_size=80))
def test_the_crc_is_the_servo_makers(data: bytes) -> None:
    assert crc(data) == SDK.updateCRC(0, data, len(data))


def test_everyone_answers_a_broadcast_ping_in_the_slot_of_its_id() -> None:
    bus = Bus([device(9), device(2, "MX-64(2.0)"), old_device(5)])
    found = bus.feed(packet(254, 1))
    assert [(reply[4], reply[9] + 256 * reply[10]) for _, reply in found] == [(2, 311), (9, 30)]
    assert found[1][0] - found[0][0] == pytest.approx(7 * 0.003)


def test_a_reading_shows_load_velocity_position_and_trajectory() -> None:
    bus = a_bus(device(1))
    servo = bus.devices[0].servo
    servo.position, servo.velocity, servo.duty = math.pi / 2, -10 * MX2_SCALE.speed, -0.25
    servo.reference, servo.rate = -math.pi / 2, 20 * MX2_SCALE.speed
    (reply,) = replies(bus, read(1, 126, 21))
    fields = (little(-250, 2), little(-10, 4), little(3072, 4), little(20, 4), little(1024, 4), b"\x78\0\x19")
    assert reply[9:-2] == b"".join(fields)


def test_only_the_larger_models_show_a_current() -> None:
    bus = a_bus(device(1), device(2, "MX-64(2.0)"))
    for unit in bus.devices:
        unit.servo.current, unit.servo.duty = 0.336, 0.5
    assert [value(bus, servo, 126, 2) for servo in (1, 2)] == [500, 100]


def test_a_goal_moves_a_servo_only_with_torque_on() -> None:
    bus = a_bus(device(1))
    assert error(bus, write(1, GOAL, 2148, 4)) == 0
    advance(bus, 1.0)
    assert value(bus, 1, 132, 4) == 2048
    holding(bus)
    advance(bus, 1.0)
    assert value(bus, 1, 132, 4) == pytest.approx(2148, abs=5)


def test_the_profile_is_a_trapezoid_and_the_trajectory_registers_show_it() -> None:
    bus = holding(a_bus(device(1)))
    profile = little(5, 4) + little(40, 4)  # 5 · 214.577 rev/min², 40 · 0.229 rev/min
    replies(bus, packet(1, 3, *little(108, 2), *profile, *little(3000, 4)))
    advance(bus, 0.018 + 0.25)
    speeds = [value(bus, 1, 136, 4)]
    advance(bus, 0.5)
    speeds.append(value(bus, 1, 136, 4))
    assert speeds[0] == pytest.approx(0.25 * 5 * 214.577 / 60 / 0.229, rel=0.05)
    assert speeds[1] == 40
    advance(bus, 3.0)
    assert (value(bus, 1, 136, 4), value(bus, 1, 140, 4)) == (0, 3000)


def test_a_sync_write_of_profile_velocity_and_goal_reaches_all() -> None:
    bus = a_bus()
    data = [1, *little(30, 4), *little(2100, 4), 2, *little(20, 4), *little(2000, 4)]
    assert replies(bus, packet(254, 0x83, *little(PROFILE, 2), 8, 0, *data)) == []
    found = [(d.get(tables2.PROFILE_VELOCITY), d.get(tables2.GOAL)) for d in bus.devices]
    assert found == [(30, 2100), (20, 2000)]


def test_a_bulk_write_gives_each_servo_its_own() -> None:
    bus = a_bus()
    first, second = (1, 65, 0, 1, 0, 1), (2, *little(GOAL, 2), 4, 0, *little(2000, 4))
    assert replies(bus, packet(254, 0x93, *first, *second)) == []
    assert value(bus, 1, 65, 1) == 1
    assert value(bus, 2, GOAL, 4) == 2000


def sync_read(*servos: int) -> bytes:
    return packet(254, 0x82, *little(132, 2), 4, 0, *servos)


def test_a_sync_read_is_answered_in_the_order_of_its_ids() -> None:
    assert [reply[4] for reply in replies(a_bus(), sync_read(2, 1))] == [2, 1]


@pytest.mark.parametrize(("silent", "heard"), [(0, []), (1, [1]), (2, [1, 2])])
def test_a_sync_read_ends_at_the_first_silent_servo(silent: int, heard: list[int]) -> None:
    bus = a_bus(device(1), device(2), device(3))
    bus.devices[silent].servo.silent = True
    assert [reply[4] for reply in replies(bus, sync_read(1, 2, 3))] == heard


def test_a_bulk_read_asks_each_for_something_else() -> None:
    request = packet(254, 0x92, 1, *little(0, 2), 2, 0, 2, *little(146, 2), 1, 0)
    assert [reply[9:-2] for reply in replies(a_bus(), request)] == [b"\x1e\x00", b"\x19"]


def test_a_fast_read_is_not_answered_by_those_who_do_not_know_it() -> None:
    bus = a_bus()
    bus.devices[1].fast = True
    assert replies(bus, packet(254, 0x8A, *little(132, 2), 4, 0, 1, 2)) == []


def test_a_fast_read_is_one_packet_with_everyone_in_it() -> None:
    bus = a_bus()
    for unit in bus.devices:
        unit.fast = True
    (reply,) = replies(bus, packet(254, 0x8A, *little(132, 2), 4, 0, 1, 2))
    assert (reply[4], reply[5] + 7, reply[7]) == (254, len(reply), 0x55)
    assert reply[8:14] == b"\0\x01" + little(2048, 4)
    assert reply[14:16] == little(crc(reply[:14]), 2)
    assert reply[16:22] == b"\0\x02" + little(2048, 4)


def test_a_fast_read_breaks_off_at_who_does_not_know_it() -> None:
    bus = a_bus()
    bus.devices[0].fast = True
    ((_, reply),) = bus.feed(packet(254, 0x9A, 1, 0, 0, 2, 0, 2, 0, 0, 2, 0))
    assert reply[5] + 7 > len(reply)


@pytest.mark.parametrize(
    ("request_", "number"),
    [
        (packet(1, 0x33), 2),  # no such instruction
        (packet(1, 5), 2),  # an action with nothing registered
        (packet(1, 2, 132), 5),  # a read without a length
        (packet(1, 3, *little(GOAL, 2), 1, 2), 5),  # half a goal
        (write(1, 65, 2), 4),  # LED is 0 or 1
        (write(1, GOAL, 4096, 4), 6),  # beyond Max Position Limit
        (write(1, 132, 1, 4), 7),  # the present position is read only
        (read(1, 200, 4), 7),  # beyond the table
        (packet(1, 1)[:-1] + b"\x00", 3),
        (packet(1, 6, 7), 4),  # no such factory reset
    ],
)
def test_mistakes_are_named_by_their_number(request_: bytes, number: int) -> None:
    assert error(a_bus(), request_) == number


def test_the_eeprom_is_locked_while_torque_is_on() -> None:
    bus = holding(a_bus(device(1)))
    assert error(bus, write(1, 9, 10)) == 7
    assert error(bus, write(1, TORQUE, 0)) == 0
    assert error(bus, write(1, 9, 10)) == 0


def test_a_request_is_unstuffed_and_a_reply_is_stuffed() -> None:
    bus = a_bus(device(1, rom={tables2.OPERATING_MODE: 4}))
    request = bytes.fromhex("FF FF FD 00 01 0A 00 03 74 00 FF FF FD FD FF 23 E5")
    assert error(bus, request) == 0
    (reply,) = replies(bus, read(1, GOAL, 4))
    assert reply[5:-2] == bytes.fromhex("09 00 55 00 FF FF FD FD FF")


def test_a_registered_write_waits_for_the_action() -> None:
    bus = a_bus(device(1))
    assert error(bus, packet(1, 4, *little(GOAL, 2), *little(2148, 4))) == 0
    assert (bus.devices[0].get(tables2.GOAL), value(bus, 1, 69, 1)) == (2048, 1)
    assert replies(bus, packet(254, 5)) == []
    assert (bus.devices[0].get(tables2.GOAL), value(bus, 1, 69, 1)) == (2148, 0)


@pytest.mark.parametrize(("level", "answers"), [(0, [1, 0, 0]), (1, [1, 1, 0]), (2, [1, 1, 1])])
def test_the_status_return_level_says_what_is_answered(level: int, answers: list[int]) -> None:
    bus = a_bus(device(1))
    replies(bus, write(1, 68, level))
    requests = (packet(1, 1), read(1, 132, 4), write(1, 65, 1))
    assert [len(replies(bus, request)) for request in requests] == answers


def test_a_sync_read_of_five_takes_two_milliseconds() -> None:
    bus = a_bus(*(device(servo) for servo in range(1, 6)))
    request = packet(254, 0x82, *little(126, 2), 21, 0, *range(1, 6))
    assert bus.feed(request)[-1][0] == pytest.approx(0.002, abs=0.0003)


@pytest.mark.parametrize(("register", "baud"), [(1, 57_600), (3, 1_000_000), (5, 3_000_000)])
def test_baud_rates_are_those_of_firmware_2(register: int, baud: int) -> None:
    bus = Bus([device(1, rom={tables2.BAUD: register})], baud)
    assert len(replies(bus, packet(1, 1))) == 1


def test_a_reboot_is_confirmed_and_followed_by_silence_and_defaults() -> None:
    bus = holding(a_bus(device(1)))
    replies(bus, write(1, 65, 1) + write(1, WATCHDOG, 100))
    assert error(bus, packet(1, 8)) == 0
    assert replies(bus, packet(1, 1)) == []
    advance(bus, 0.31)
    assert [value(bus, 1, address, 1) for address in (TORQUE, 65, WATCHDOG, 7)] == [0, 0, 0, 1]


@pytest.mark.parametrize(("option", "id_", "baud"), [(0xFF, 1, 57_600), (1, 7, 57_600), (2, 7, 1_000_000)])
def test_a_factory_reset_spares_what_it_is_told_to(option: int, id_: int, baud: int) -> None:
    bus = a_bus(device(7))
    replies(bus, write(7, 31, 60))
    assert error(bus, packet(7, 6, option)) == 0
    advance(bus, 0.31)
    bus.baud = baud
    assert value(bus, id_, 31, 1) == 80


def test_a_broadcast_does_not_make_all_ids_the_same() -> None:
    bus = a_bus()
    assert replies(bus, packet(254, 6, 0xFF)) == []
    assert [unit.id for unit in bus.devices] == [1, 2]


def test_an_overload_alerts_and_only_a_reboot_ends_it() -> None:
    bus = holding(a_bus(device(1)))
    bus.devices[0].servo.trip("overload")
    assert error(bus, packet(1, 1)) == 0x80
    assert value(bus, 1, HARDWARE_ERROR, 1) == 32
    assert value(bus, 1, TORQUE, 1) == 0
    assert error(bus, write(1, TORQUE, 1)) == 0x87
    assert error(bus, write(1, HARDWARE_ERROR, 0)) == 0x87
    replies(bus, packet(1, 8))
    advance(bus, 0.31)
    assert value(bus, 1, HARDWARE_ERROR, 1) == 0
    assert error(bus, write(1, TORQUE, 1)) == 0


def test_a_low_voltage_alerts_and_leaves_torque_on() -> None:
    bus = holding(a_bus(device(1)))
    bus.devices[0].servo.supply = 9.0
    assert error(bus, packet(1, 1)) == 0x80
    assert (value(bus, 1, HARDWARE_ERROR, 1), value(bus, 1, TORQUE, 1)) == (1, 1)


def test_the_bus_watchdog_stops_a_servo_that_hears_nothing() -> None:
    bus = holding(a_bus(device(1)))
    replies(bus, write(1, WATCHDOG, 10))
    profile = little(40, 4) + little(4000, 4)
    replies(bus, packet(1, 3, *little(PROFILE, 2), *profile))
    for _ in range(5):
        advance(bus, 0.15)
        replies(bus, sync_read(1))
    assert value(bus, 1, WATCHDOG, 1) == 10
    assert value(bus, 1, 136, 4) == 40
    advance(bus, 0.25)
    assert value(bus, 1, WATCHDOG, 1) == -1
    stopped = value(bus, 1, 132, 4)
    advance(bus, 1.0)
    assert value(bus, 1, 132, 4) == pytest.approx(stopped, abs=12)
    assert value(bus, 1, TORQUE, 1) == 1


def test_a_watchdog_that_has_tripped_locks_the_goals_until_it_is_cleared() -> None:
    bus = holding(a_bus(device(1)))
    bus.devices[0].servo.bite()
    assert error(bus, write(1, GOAL, 2100, 4)) == 4
    assert error(bus, write(1, WATCHDOG, 10)) == 4
    assert error(bus, write(1, PROFILE, 40, 4)) == 0
    assert error(bus, write(1, WATCHDOG, 0)) == 0
    assert error(bus, write(1, GOAL, 2100, 4)) == 0
    advance(bus, 2.0)
    assert value(bus, 1, 132, 4) == pytest.approx(2100, abs=5)


def test_nothing_moves_when_a_watchdog_is_cleared() -> None:
    bus = holding(a_bus(device(1)))
    replies(bus, packet(1, 3, *little(PROFILE, 2), *little(40, 4), *little(4000, 4)))
    advance(bus, 0.5)
    bus.devices[0].servo.bite()
    advance(bus, 0.5)
    stopped = value(bus, 1, 132, 4)
    replies(bus, write(1, WATCHDOG, 0) + write(1, PROFILE, 20, 4))
    advance(bus, 1.0)
    assert value(bus, 1, 132, 4) == stopped


def test_servos_of_both_protocols_share_a_line_and_answer_their_own() -> None:
    bus = a_bus(device(1), old_device(2))
    old_ping = bytes.fromhex("FF FF 02 02 01 FA")
    assert [reply[:5] for reply in replies_of_both(bus, packet(1, 1) + old_ping + packet(1, 1))] == [
        b"\xff\xff\xfd\x00\x01",
        b"\xff\xff\x02\x02\x00",
        b"\xff\xff\xfd\x00\x01",
    ]
    assert replies_of_both(bus, packet(2, 1) + bytes.fromhex("FF FF 01 02 01 FB")) == []


def replies_of_both(bus: Bus, data: bytes) -> list[bytes]:
    return [reply for _, reply in bus.feed(data)]


def test_firmware_2_can_be_told_to_speak_protocol_1() -> None:
    bus = a_bus(device(1, rom={tables2.PROTOCOL_TYPE: 1}))
    assert replies(bus, packet(1, 1)) == []
    (reply,) = replies_of_both(bus, bytes.fromhex("FF FF 01 04 02 84 04 70"))
    assert reply[5:-1] == little(2048, 4)


def test_a_noisy_packet_does_not_keep_the_next_one_from_being_heard() -> None:
    bus = a_bus()
    assert len(replies(bus, b"\xff\xff\xfd\x00\x01\xff\xff" + packet(1, 1))) == 1


def test_a_packet_that_was_begun_can_be_forgotten() -> None:
    bus = a_bus()
    assert replies(bus, packet(1, 1)[:8]) == []
    bus.forget()
    assert len(replies(bus, packet(1, 1))) == 1


def test_statuses_that_come_by_are_no_requests() -> None:
    assert replies(a_bus(), packet(1, 0x55, 0)) == []


STARTS = st.sampled_from([b"", b"\xff\xff", packets2.HEADER, b"\xff\xff\xfd\x00\xfe"])


@given(st.lists(st.builds(bytes.__add__, STARTS, st.binary(max_size=64)), max_size=8))
def test_random_bytes_never_raise_and_are_not_hoarded(chunks: list[bytes]) -> None:
    bus = Bus([device(1), old_device(2)])
    for chunk in chunks:
        bus.feed(chunk)
    bus.forget()
    bus.baud = 1_000_000
    advance(bus, 0.4)
    for unit in bus.devices:
        unit.provision(unit.table.common.id, 9)
        unit.provision(unit.table.common.baud, unit.table.baud_register(1_000_000))
    assert len(bus.feed(packet(9, 1))) <= 1


INSTRUCTIONS = st.sampled_from(list(packets2.Instruction)) | st.integers(0, 255)


@given(st.sampled_from([0, 1, 2, 254]), INSTRUCTIONS, st.binary(max_size=40))
def test_sound_packets_with_random_contents_never_raise(servo: int, code: int, parameters: bytes) -> None:
    bus = a_bus()
    for unit in bus.devices:
        unit.fast = True
    bus.feed(packet(servo, code, *parameters))
    advance(bus, 0.005)
    bus.feed(read(1, 0, 147))


@given(st.binary(max_size=200), st.lists(st.integers(0, 220), max_size=6))
def test_where_the_bytes_are_cut_makes_no_difference(data: bytes, cuts: list[int]) -> None:
    data += packet(1, 1)
    edges = [0, *sorted(min(cut, len(data)) for cut in cuts), len(data)]
    whole, pieces = Parser(), Parser()
    in_pieces = [r for a, b in pairwise(edges) for r in pieces.feed(data[a:b])]
    found = [(r.servo, r.instruction, r.parameters, r.sound) for r in whole.feed(data)]
    assert [(r.servo, r.instruction, r.parameters, r.sound) for r in in_pieces] == found


@given(st.integers(0, 252))
def test_a_protocol_1_parser_sees_nothing_in_a_ping_of_protocol_2(servo: int) -> None:
    assert packets1.Parser().feed(packet(servo, 1)) == []
