"""Effort as volts."""

import numpy as np
import pytest

from sim.clock import VirtualClock
from sim.people.electrodes import FULL, REST, THRESHOLD, Electrodes
from sim.people.scene import Act


async def mean_levels(act: Act, blocks: int = 2000) -> list[float]:
    """Mean absolute value (V) of each channel while somebody does `act`."""
    source = Electrodes(lambda: act, 200.0, VirtualClock(), 1)
    taken = []
    async for block in source:
        taken.append(block.samples)
        if len(taken) == blocks:
            break
    return [float(level) for level in np.mean(np.abs(np.concatenate(taken)), axis=0)]


@pytest.mark.parametrize(("effort", "channel"), [(0.5, 0), (-0.5, 1)])
async def test_effort_shows_on_the_muscle_of_its_direction(effort: float, channel: int) -> None:
    levels = await mean_levels(Act(effort))
    assert levels[channel] == pytest.approx((THRESHOLD + FULL) / 2, rel=0.05)
    assert levels[1 - channel] == pytest.approx(REST, rel=0.05)
    assert levels[2] == pytest.approx(REST, rel=0.05)


async def test_a_toggle_is_a_contraction_of_the_other_forearm() -> None:
    assert (await mean_levels(Act(toggle=True)))[2] == pytest.approx(FULL, rel=0.05)


async def test_samples_come_at_their_rate_without_gaps() -> None:
    clock = VirtualClock()
    begun, following = clock.now(), 0
    async for block in Electrodes(Act, 200.0, clock, 1):
        assert block.first_index == following
        assert clock.now() >= block.time + len(block.samples) / 200.0 - 1e-9
        following += len(block.samples)
        if following >= 200:
            break
    assert clock.now() - begun == pytest.approx(1.0)
