"""Clients' work waits for the tick, takes turns, and never has more of the loop than its share."""

import asyncio
from collections.abc import Callable

import pytest

from bentod.gate import AT_ONCE, MOST, SHARE, Gate
from sim.clock import VirtualLoop


@pytest.fixture
async def gate() -> Gate:
    return Gate()


def pieces(done: list[str], name: str, number: int, cost: float = 0.0) -> Callable[[], bool]:
    """Work in so many pieces, each of which takes `cost` (s) and leaves its name."""

    def one() -> bool:
        loop = asyncio.get_running_loop()
        assert isinstance(loop, VirtualLoop)
        loop.block(cost)
        done.append(name)
        return done.count(name) < number

    return one


async def test_nothing_gets_through_while_a_tick_is_under_way(gate: Gate) -> None:
    done: list[str] = []
    with gate.shut():
        waiting = gate.submit(pieces(done, "a", 3))
        await asyncio.sleep(1)
        assert done == []
    await waiting
    assert done == ["a"] * 3


async def test_a_tick_that_breaks_opens_the_gate_again(gate: Gate) -> None:
    def tick() -> None:
        with gate.shut():
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        tick()
    await gate.submit(pieces([], "a", 1))


async def test_clients_take_turns_piece_by_piece(gate: Gate) -> None:
    done: list[str] = []
    await asyncio.gather(*(gate.submit(pieces(done, name, 3)) for name in "abc"))
    assert done == list("abcabcabc")


async def test_one_turn_of_the_loop_does_few_pieces_however_small(gate: Gate) -> None:
    done: list[str] = []
    gate.submit(pieces(done, "a", 100 * MOST))
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert len(done) == MOST


async def test_a_long_piece_ends_its_slice(gate: Gate) -> None:
    done: list[str] = []
    gate.submit(pieces(done, "a", 10, cost=0.002))
    await asyncio.sleep(0)
    await asyncio.sleep(0)
    assert len(done) == 1


async def test_clients_together_have_no_more_than_their_share_of_the_loop(gate: Gate) -> None:
    done: list[str] = []
    for name in "abcdefgh":
        gate.submit(pieces(done, name, 10**6, cost=0.0005))
    await asyncio.sleep(10)
    assert len(done) * 0.0005 == pytest.approx(10 * SHARE, rel=0.05)


async def test_after_every_tick_something_gets_through_even_if_the_next_is_overdue(gate: Gate) -> None:
    done: list[str] = []
    gate.submit(pieces(done, "a", 10**6, cost=AT_ONCE))
    for tick in range(1, 50):
        with gate.shut():
            await asyncio.sleep(0.1)
        await asyncio.sleep(0)
        assert len(done) >= tick


async def test_whoever_gives_up_waiting_holds_nobody_up(gate: Gate) -> None:
    done: list[str] = []
    with gate.shut():
        first, second = gate.submit(pieces(done, "a", 1)), gate.submit(pieces(done, "b", 1))
        first.cancel()
    await second
    assert done == ["b"]


async def test_an_error_is_for_whoever_waits_and_for_nobody_else(gate: Gate) -> None:
    def broken() -> bool:
        raise ZeroDivisionError("oops")

    done: list[str] = []
    one, other = gate.submit(broken), gate.submit(pieces(done, "a", 2))
    with pytest.raises(ZeroDivisionError, match="oops"):
        await one
    await other
