"""Combinations of a sweep in processes of their own, on this machine. Needs joblib."""

from collections.abc import Iterator, Sequence
from typing import cast

from joblib import Parallel, delayed, parallel_config

from bentod.replay.sweep import Outcome, Point, Told, Work


def run(jobs: int, work: Work, tried: Sequence[Point], told: Told) -> list[Outcome]:
    """What comes of all combinations, in their order; `told` hears of each as soon as it is there.

    `jobs`: how many are under way at once. A process that dies takes those with it that were under way beside
    it; each of them is tried again by itself, and the one that dies again has failed.

    However many processes there are, each computes with one thread: sums over many numbers depend on how many
    threads share them, and results must not depend on `jobs`.
    """
    found: dict[int, Outcome] = {}

    def take(outcome: Outcome) -> None:
        found[outcome.point.place] = outcome
        told(outcome)

    with parallel_config(backend="loky", n_jobs=max(jobs, 2), inner_max_num_threads=1):
        left = list(tried)
        while left and _broken(work, left, jobs, take):
            left = [point for point in tried if point.place not in found]
            _one_by_one(work, left[:jobs], take)  # they begin in order, so these were under way
            left = [point for point in tried if point.place not in found]
    return [found[point.place] for point in tried]


def _one_by_one(work: Work, tried: Sequence[Point], take: Told) -> None:
    for point in tried:
        if why := _broken(work, [point], 1, take):
            take(Outcome(point, failed=f"its process died: {why}"))


def _broken(work: Work, tried: Sequence[Point], jobs: int, take: Told) -> str:
    """Why not all were done; empty if they were."""
    # With one process joblib would do the work in this one, which then dies with it: so there are two, but
    # no more than `jobs` combinations under way.
    parallel = Parallel(return_as="generator_unordered", pre_dispatch=jobs, batch_size=1)
    try:
        for outcome in cast("Iterator[Outcome]", parallel(delayed(work)(point) for point in tried)):
            take(outcome)
    except Exception as error:  # noqa: BLE001 -- each kind of pool has errors of its own for a dead process
        return f"{type(error).__name__}: {str(error).strip().partition(chr(10))[0]}"
    return ""
