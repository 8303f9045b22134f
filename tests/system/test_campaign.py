"""Whatever breaks around an arm in motion, it does not move on beyond the bound, says why, and recovers."""

import pytest

from tests.system.campaign import real_faults
from tests.system.campaign.__main__ import BEGIN, END, VIRTUAL, renewed
from tests.system.campaign.case import Case, undergo
from tests.system.campaign.outcome import Bound, Moved, Outcome, table, worst

BUSY = 3.0
"""s that a busy machine may add: here it matters what comes, not when."""


@pytest.mark.parametrize("case", VIRTUAL, ids=lambda case: case.fault)
async def test_a_fault_in_motion_keeps_its_promises(case: Case) -> None:
    assert (await undergo(case, seed=0)).broken() == []


@pytest.mark.real_time
@pytest.mark.parametrize("case", real_faults.CASES, ids=lambda case: case.__name__)
async def test_a_fault_of_a_real_process_keeps_its_promises(case: real_faults.RealCase) -> None:
    assert (await case()).broken(BUSY) == []


def outcome(seconds: float = 0.1, degrees: float = 1.0, strayed: float = 0.0, **more: object) -> Outcome:
    told, recovery = str(more.get("told", "cable")), str(more.get("recovery", "release"))
    moved = Moved(degrees, seconds)
    went_on = more.get("went_on", True) is True
    bound = Bound(0.5, "lease")
    return Outcome("cable", "client", bound, moved, strayed, went_on, told, recovery, "cable", ("release",))


@pytest.mark.parametrize(
    ("seen", "complaint"),
    [
        (outcome(seconds=0.6), "moved on for 0.600 s, bound 0.500 s"),
        (outcome(degrees=40), "moved on by 40.0°"),
        (outcome(strayed=2), "2.0° away unasked"),
        (outcome(went_on=False), "did not do what was asked"),
        (outcome(told=""), "nothing of 'cable'"),
        (outcome(recovery="restart"), "only by: restart"),
    ],
)
def test_a_broken_promise_is_told(seen: Outcome, complaint: str) -> None:
    assert len(seen.broken()) == 1
    assert complaint in seen.broken()[0]
    assert outcome().broken() == []


def test_the_worst_of_several_is_what_counts() -> None:
    seen = worst([outcome(seconds=0.2), outcome(degrees=3, recovery="restart")])
    assert (seen.moved, seen.recovery) == (Moved(3, 0.2), "release; or restart")


def test_the_table_has_a_row_for_each_fault_and_goes_where_it_belongs() -> None:
    rows = table([outcome(), outcome()])
    assert rows.count("\n| cable | client | 100 ms, 1.0° |") == 2
    page = renewed(f"a\n{BEGIN}\nold\n{END}\nb", rows)
    assert page == f"a\n{BEGIN}\n\n{rows}\n\n{END}\nb"
