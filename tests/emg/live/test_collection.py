"""A guided collection: prompts by sample, what is kept, and everything that ends it."""

import numpy as np
import pytest

from bentod.emg.live.collection import Collection, Session
from bentod.emg.live.plan import Plan, planned
from bentod.errors import BadRequest

RATE_HZ = 100.0
PLAN = Plan(("close", "open"), 1.0, 0.5, 2)


class Listener:
    def __init__(self) -> None:
        self.told: list[tuple[Session | None, str]] = []

    def __call__(self, session: Session | None, why: str) -> None:
        self.told.append((session, why))


def run(collection: Collection, ticks: int, each: int = 5, problem: str = "") -> list[str]:
    """Prompts of so many ticks; each sample's value is its index."""
    texts = []
    for tick in range(ticks):
        newest = 1000 + tick * each
        samples = np.arange(newest - each, newest)[:, np.newaxis] * np.ones((1, 3), np.float32)
        told = collection.take(newest, samples.astype(np.float32), newest / RATE_HZ, problem)
        texts += [one.text for one in told]
    return texts


def test_prompts_come_in_order_and_the_session_is_whole() -> None:
    listener = Listener()
    collection = Collection(PLAN, RATE_HZ, (2, 0), listener)
    texts = run(collection, 200)
    assert texts[:4] == ["Rest, 0.5 s.", "close, 1 s (1 of 2).", "Rest, 0.5 s.", "open, 1 s (1 of 2)."]
    assert len(texts) == 9
    ((session, why),) = listener.told
    assert session is not None
    assert why == ""
    assert session.samples.shape == (PLAN.samples(RATE_HZ), 2)
    assert session.samples[:, 0].tolist() == list(range(1000, 1000 + PLAN.samples(RATE_HZ)))
    assert [(p.label, p.repetition, p.shown, p.hidden) for p in session.prompts] == [
        ("close", 0, 50, 150),
        ("open", 0, 200, 300),
        ("close", 1, 350, 450),
        ("open", 1, 500, 600),
    ]


def test_late_ticks_lose_no_sample_and_shift_nothing() -> None:
    listener = Listener()
    run(Collection(PLAN, RATE_HZ, (0,), listener), 12, each=70)
    session = listener.told[0][0]
    assert session is not None
    assert session.samples[:, 0].tolist() == list(range(1000, 1000 + PLAN.samples(RATE_HZ)))


def test_a_source_that_dies_ends_it_once_and_a_short_gap_does_not() -> None:
    listener = Listener()
    collection = Collection(PLAN, RATE_HZ, (0,), listener)
    run(collection, 8, problem="No EMG sample.")
    assert listener.told == []
    run(collection, 40, problem="No EMG sample.")
    assert listener.told == [(None, "No EMG sample.")]
    collection.cancel("again")
    assert len(listener.told) == 1


@pytest.mark.parametrize(
    ("classes", "hold", "repetitions", "sentence"),
    [
        (["clsoe"], 3.0, 3, "there is no class 'clsoe'"),
        (["close", "close"], 3.0, 3, "named twice"),
        ([], 30.0, 50, "the bound is 3600 s"),
    ],
)
def test_a_plan_that_makes_no_sense_is_refused(
    classes: list[str], hold: float, repetitions: int, sentence: str
) -> None:
    with pytest.raises(BadRequest, match=sentence):
        planned(classes, hold, 30.0, repetitions, ("close", "open"), 1000.0, 8)


def test_a_plan_that_would_fill_the_memory_is_refused() -> None:
    with pytest.raises(BadRequest, match=r"values; the bound is 2e\+07"):
        planned([], 10.0, 10.0, 20, ("close", "open"), 10_000.0, 64)
