"""Whatever a client sends, the daemon answers once, ticks on, and keeps the arm within its limits."""

import gc
import tempfile
from collections.abc import Awaitable, Callable
from pathlib import Path
from random import Random

from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from sim.clock import run
from tests.fuzz.grammar import Call, Grammar, pieces
from tests.fuzz.siege import Siege, besieged
from tests.rig import PLAIN, quiet_config, running

quickly = settings(
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    max_examples=8,
    phases=[
        Phase.reuse,
        Phase.generate,
    ],  # a whole daemon for each step towards a smaller example takes minutes
)

seeds = st.integers(0, 2**32)
"""Of one call or one stream each: what fails is found again with fewer of them."""


def besiege(attack: Callable[[Siege], Awaitable[None]]) -> None:
    """Let a fresh daemon be attacked, and see that it holds."""

    async def main(path: Path) -> None:
        async with running(quiet_config(PLAIN), path) as arm, besieged(path, arm) as siege:
            await attack(siege)
            await siege.verify()
            assert siege.watch.frames > 30

    with tempfile.TemporaryDirectory() as folder:
        run(main(Path(folder, "bentod.sock")))


@given(st.data())
@quickly
def test_every_method_with_any_arguments_is_answered_once(data: st.DataObject) -> None:
    async def attack(siege: Siege) -> None:
        methods = [str(method["name"]) for method in siege.grammar.methods]
        for wild in (0.0, 0.9):
            order = data.draw(st.permutations(methods))
            calls = [siege.grammar.call(Random(data.draw(seeds)), method, wild) for method in order]
            await siege.calls([(calls, 0.2)])

    besiege(attack)


@given(st.lists(st.tuples(seeds, st.floats(0.0, 0.3)), min_size=10, max_size=40))
@quickly
def test_no_calls_whatever_move_the_arm_out_of_bounds_or_a_tick_out_of_time(
    steps: list[tuple[int, float]],
) -> None:
    async def attack(siege: Siege) -> None:
        for moves in (False, True):
            await siege.calls((burst(siege.grammar, Random(seed), moves), pause) for seed, pause in steps)
            await siege.recover()

    besiege(attack)


def burst(grammar: Grammar, random: Random, moves: bool) -> list[Call]:
    """A few calls at once, some of which move the arm."""
    some = ["move", "group_command", "group_toggle", "go_home", ""] if moves else [""]
    return [grammar.call(random, random.choice(some), 0.2) for _ in range(random.choice([1, 2, 50]))]


@given(st.lists(seeds, min_size=6, max_size=12))
@quickly
def test_any_bytes_are_answered_or_hung_up_on_and_disturb_nobody_else(streams: list[int]) -> None:
    async def attack(siege: Siege) -> None:
        for seed in streams:
            await siege.bytes(pieces(siege.grammar.stream(Random(seed)), Random(seed)))

    besiege(attack)


def test_nothing_is_kept_of_clients_that_have_left(tmp_path: Path) -> None:
    async def main(path: Path) -> None:
        async with running(quiet_config(PLAIN), path) as arm, besieged(path, arm) as siege:
            await _visits(siege, 20, 1)
            before = _objects()
            await _visits(siege, 60, 2)
            assert _objects() - before < 60 * 5
            await siege.verify()

    run(main(tmp_path / "bentod.sock"))


async def _visits(siege: Siege, number: int, seed: int) -> None:
    random = Random(seed)
    for _ in range(number):
        await siege.bytes(pieces(siege.grammar.stream(random), random))
        await siege.calls([([("hello", ["me"]), siege.grammar.call(random, "move")], 0.0)])


def _objects() -> int:
    gc.collect()
    return len(gc.get_objects())
