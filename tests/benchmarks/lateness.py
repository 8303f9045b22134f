"""How late the daemon's tick starts at 30 Hz on the real clock, beside a naive loop that only sleeps.

All in this process, in turns, nobody connected. A tick of the daemon is late against its deadline, which is
absolute: what one tick loses, the next must win back. The naive loop is judged by its own last waking: late
is what it sleeps beyond a period. That it does nothing in between and drifts away is not held against it.

The promise is of an idle daemon: it reads, learns and writes at every tick, but nobody asks anything of it. A
wearer's samples come in at moments of their own, some of them just before a tick; that is shown beside it.
`tick` has other rates, a load, and other ways to tick.
"""

import statistics
from collections.abc import Iterator, Sequence
from functools import partial

from bentod.lateness.histogram import percentile
from bentod.lateness.trial import DAEMON, SLEEP, Case, Round, Way, burst, trial, undisturbed, ways
from tests.benchmarks.harness import Row, at_most, main
from tests.rig import quiet_config, sim_config

RATE_HZ = 30.0
SECONDS = 7.0  # of each, in a round
ROUNDS, MOST_ROUNDS = 6, 12

IDLE, WORN, NAIVE = (Case(way, RATE_HZ, False) for way in ("idle", "with a wearer", SLEEP))


def rows() -> Iterator[Row]:
    """Two and a half minutes on a calm machine, up to twice as long on another."""
    quiet, worn = quiet_config(), sim_config()
    kinds: dict[Case, tuple[Way, Case]] = {
        IDLE: (ways(quiet)[DAEMON], IDLE),
        WORN: (ways(worn)[DAEMON], WORN),
        NAIVE: (ways(quiet)[SLEEP], NAIVE),
    }
    measured = {case: partial(burst, *kind, SECONDS, quiet.realtime) for case, kind in kinds.items()}
    rounds = trial(measured, lambda what: None, ROUNDS, MOST_ROUNDS)
    counted = undisturbed(rounds)
    for share in (0.99, 0.5):
        what = f"lateness at 30 Hz, p{share * 100:g} of the"
        idle, worn_, naive = (_median(counted, case, share) for case in (IDLE, WORN, NAIVE))
        yield at_most(f"{what} idle tick / naive sleep", idle / naive, "", 0.5)
        yield Row(f"{what} tick with a wearer / naive sleep", worn_ / naive, "")
        yield from _spread(counted, share)
    yield Row("  ticks of each that count", sum(len(one.found[IDLE].late) for one in counted), "")
    yield Row("  rounds undisturbed by the host", sum(one.calm for one in rounds), f"of {len(rounds)}")
    yield Row("  the host took, in those that count", statistics.fmean(r.stolen for r in counted) * 100, "%")


def _each(rounds: Sequence[Round], case: Case, share: float) -> list[float]:
    """A percentile of each round (s)."""
    return [percentile(one.found[case].late, share) for one in rounds]


def _median(rounds: Sequence[Round], case: Case, share: float) -> float:
    return statistics.median(_each(rounds, case, share))


def _spread(rounds: Sequence[Round], share: float) -> Iterator[Row]:
    for case in (IDLE, WORN, NAIVE):
        each = _each(rounds, case, share)
        yield Row(f"  {case.way}, median of the rounds", statistics.median(each) * 1e6, "µs")
        yield Row(f"  {case.way}, least round", min(each) * 1e6, "µs")
        yield Row(f"  {case.way}, greatest round", max(each) * 1e6, "µs")


if __name__ == "__main__":
    main("lateness", rows())
