import asyncio

import pytest

from drivers.dynamixel.bus import SLOWEST_RETURN, Bus
from sim.clock import VirtualClock
from tests.drivers.dynamixel.wire import Wire, status

MARGIN = 0.005
READ_1 = "FF FF 01 04 02 24 02 D2"  # id 1, Present Position
READ_2 = "FF FF 02 04 02 24 02 D1"
BULK_1_2 = "FF FF FE 09 92 00 02 01 24 02 02 24 17"
CENTRE_1 = status(1, 0x00, 0x08)
CENTRE_2 = status(2, 0x00, 0x08)


@pytest.fixture
def wire() -> Wire:
    return Wire()


@pytest.fixture
async def bus(wire: Wire, clock: VirtualClock) -> Bus:
    bus = Bus(wire, clock, 1_000_000, MARGIN)
    for id_ in (1, 2, 3):
        bus.set_return_delay(id_, 0.0)
    return bus


async def test_a_reading_ends_with_its_reply(bus: Bus, wire: Wire, clock: VirtualClock) -> None:
    wire.expect(READ_1, CENTRE_1, after=0.002)
    replies = await bus.read(1, [1], 36, 2)
    assert {id_: (reply.error, reply.data) for id_, reply in replies.items()} == {1: (0, b"\x00\x08")}
    assert replies[1].time == clock.now() == pytest.approx(0.002)


async def test_several_are_read_at_once_and_the_last_reply_ends_it(
    bus: Bus, wire: Wire, clock: VirtualClock
) -> None:
    wire.expect(BULK_1_2, CENTRE_1, CENTRE_2)
    replies = await bus.read(1, [1, 2], 36, 2)
    assert list(replies) == [1, 2]
    assert clock.now() == pytest.approx(0.002)


async def test_a_reply_in_pieces_is_one_reply(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, CENTRE_1[:3], CENTRE_1[3:5], CENTRE_1[5:])
    assert 1 in await bus.read(1, [1], 36, 2)


async def test_an_error_byte_is_data(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, status(1, 0x00, 0x08, error=0x24))
    assert (await bus.read(1, [1], 36, 2))[1].error == 0x24


async def test_silence_ends_at_the_time_on_the_wire_and_the_margin(
    bus: Bus, wire: Wire, clock: VirtualClock
) -> None:
    wire.expect(READ_1)
    assert await bus.read(1, [1], 36, 2) == {}
    assert clock.now() == pytest.approx(16 * 10e-6 + MARGIN)
    assert bus.longest_read(1, [1], 2) == pytest.approx(16 * 10e-6 + MARGIN)


async def test_a_servo_that_waits_before_it_replies_is_waited_for(wire: Wire, clock: VirtualClock) -> None:
    bus = Bus(wire, clock, 1_000_000, MARGIN)
    wire.expect(READ_1)
    await bus.read(1, [1], 36, 2)
    assert clock.now() == pytest.approx(16 * 10e-6 + SLOWEST_RETURN + MARGIN)


async def test_who_answered_before_the_chain_broke_is_kept(bus: Bus, wire: Wire) -> None:
    wire.expect(BULK_1_2, CENTRE_1)
    assert list(await bus.read(1, [1, 2], 36, 2)) == [1]


async def test_a_damaged_reply_does_not_keep_the_bus_waiting(
    bus: Bus, wire: Wire, clock: VirtualClock
) -> None:
    wire.expect(BULK_1_2, CENTRE_1[:-1] + b"\x00", CENTRE_2)
    assert list(await bus.read(1, [1, 2], 36, 2)) == [2]
    assert clock.now() == pytest.approx(0.002)


async def test_noise_before_a_reply_is_passed_over(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, b"\x00\xff\xff\x01\x90\xff" + CENTRE_1)
    assert 1 in await bus.read(1, [1], 36, 2)


async def test_replies_of_others_and_of_another_size_are_not_the_answer(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, CENTRE_2, status(1, 0x20), CENTRE_1)
    assert (await bus.read(1, [1], 36, 2))[1].data == b"\x00\x08"


async def test_a_reply_that_is_late_is_not_the_answer_to_the_next_question(
    bus: Bus, wire: Wire, clock: VirtualClock
) -> None:
    wire.expect(READ_1, status(1, 0x20), after=2 * MARGIN)
    assert await bus.read(1, [1], 36, 2) == {}
    wire.expect(READ_2, CENTRE_2, after=0.004)
    await clock.sleep_until(1.5 * MARGIN)
    assert list(await bus.read(1, [2], 36, 2)) == [2]


async def test_the_beginning_of_a_late_reply_does_not_spoil_the_next(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, CENTRE_1[:5])
    assert await bus.read(1, [1], 36, 2) == {}
    wire.expect(READ_1, CENTRE_1)
    assert 1 in await bus.read(1, [1], 36, 2)


async def test_bytes_that_nobody_asked_for_are_dropped(bus: Bus, wire: Wire) -> None:
    wire.deliver(status(1, 0xFF, 0x0F))
    wire.expect(READ_1, CENTRE_1)
    assert (await bus.read(1, [1], 36, 2))[1].data == b"\x00\x08"


async def test_an_adapter_that_echoes_does_not_answer_for_the_servo(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, READ_1, CENTRE_1)
    assert (await bus.read(1, [1], 36, 2))[1].data == b"\x00\x08"
    wire.expect(READ_1, READ_1)
    assert await bus.read(1, [1], 36, 2) == {}


async def test_a_write_is_confirmed_by_the_servo(bus: Bus, wire: Wire) -> None:
    wire.expect("FF FF 01 04 03 18 01 DE", "FF FF 01 02 00 FC")
    assert await bus.write(1, 1, 24, b"\x01") is not None
    wire.expect("FF FF 01 04 03 18 01 DE")
    assert await bus.write(1, 1, 24, b"\x01") is None


async def test_a_sync_write_waits_for_nobody(bus: Bus, wire: Wire, clock: VirtualClock) -> None:
    wire.expect("FF FF FE 0E 83 1E 04 00 10 00 50 01 01 20 02 60 03 67")
    bus.sync_write(1, 30, {0: b"\x10\x00\x50\x01", 1: b"\x20\x02\x60\x03"})
    assert clock.now() == 0


async def test_two_questions_at_once_are_a_mistake_of_the_caller(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1, CENTRE_1)
    first = asyncio.create_task(bus.read(1, [1], 36, 2))
    await asyncio.sleep(0)
    with pytest.raises(RuntimeError, match="twice"):
        await bus.read(1, [2], 36, 2)
    assert 1 in await first


async def test_a_question_that_was_cancelled_leaves_the_bus_free(bus: Bus, wire: Wire) -> None:
    wire.expect(READ_1)
    first = asyncio.create_task(bus.read(1, [1], 36, 2))
    await asyncio.sleep(0)
    first.cancel()
    with pytest.raises(asyncio.CancelledError):
        await first
    wire.expect(READ_2, CENTRE_2)
    assert 2 in await bus.read(1, [2], 36, 2)


async def test_a_line_that_goes_ends_the_question_at_once(bus: Bus, wire: Wire, clock: VirtualClock) -> None:
    wire.expect(READ_1)
    asyncio.get_running_loop().call_later(0.001, wire.lose, "The adapter was unplugged.")
    assert await bus.read(1, [1], 36, 2) == {}
    assert clock.now() == pytest.approx(0.001)
    assert bus.problem == "The adapter was unplugged."


async def test_nothing_is_sent_on_a_line_that_is_gone(bus: Bus, wire: Wire) -> None:
    wire.gone = "The port is closed."
    bus.sync_write(1, 30, {1: b"\x00\x08\x43\x00"})
    assert bus.problem == "The port is closed."
    assert await bus.read(1, [1], 36, 2) == {}
    assert await bus.ping(1, 1) is None


async def test_settling_lasts_as_long_as_a_late_reply_may(bus: Bus, clock: VirtualClock) -> None:
    await bus.settle()
    assert clock.now() == pytest.approx(MARGIN)
