import numpy as np
import pytest

from bentod.calibration.estimate import Motion, Record, estimate, reference

TICK = 2 * np.pi / 4096


def lagging(distance: float, motion: Motion, per_load: float = 0.2, phase: float = 0.0) -> Record:
    """A joint that hangs behind its reference by its load, which follows with a delay; read in ticks."""
    fine = np.arange(-0.03, 0.8, 0.0001)
    lead = reference(fine, distance, motion)
    position = np.zeros_like(lead)
    for i in range(1, len(fine)):
        position[i] = position[i - 1] + 0.0001 / 0.03 * (lead[i - 1] - position[i - 1])
    chosen = np.arange(int(phase * 10), len(fine), 23)
    load = (lead - position) / per_load
    return Record(
        times=fine[chosen],
        positions=np.round(position[chosen] / TICK) * TICK,
        velocities=np.gradient(position, fine)[chosen],
        loads=np.round(load[chosen], 3),
        distance=distance,
        speed=motion.speed,
    )


def steps(motion: Motion) -> list[Record]:
    return [lagging(0.09, motion), lagging(-0.09, motion, phase=0.7)]


@pytest.mark.parametrize("dead_time", [0.0, 0.005, 0.017, 0.05, 0.1])
def test_the_dead_time_is_found_behind_the_lag_of_the_joint(dead_time: float) -> None:
    assert estimate(steps(Motion(dead_time, 0.7, 0.0))).dead_time == pytest.approx(dead_time, abs=6e-4)


@pytest.mark.parametrize("acceleration", [2.0, 6.0])
def test_a_ramp_that_nobody_knew_of_is_found(acceleration: float) -> None:
    found = estimate(steps(Motion(0.017, 0.7, 0.7 / acceleration)))
    assert found.deceleration == pytest.approx(acceleration, rel=0.2)
    assert found.dead_time == pytest.approx(0.017, abs=0.003)


def test_what_is_believed_is_kept_while_it_explains_the_steps() -> None:
    found = estimate(steps(Motion(0.017, 0.7, 0.35)), acceleration=2.0)
    assert found.deceleration == pytest.approx(2.0, rel=0.05)
    assert estimate(steps(Motion(0.017, 0.7, 0.0))).deceleration == 0.0


def test_a_joint_that_did_not_go_its_way_is_refused() -> None:
    blocked = lagging(0.03, Motion(0.017, 0.7, 0.0))
    told = Record(blocked.times, blocked.positions, blocked.velocities, blocked.loads, 0.09, 0.7)
    with pytest.raises(ValueError, match="34% of the way"):
        estimate([told, told])


def test_too_few_readings_are_refused() -> None:
    record = lagging(0.09, Motion(0.017, 0.7, 0.0))
    thin = Record(
        record.times[::10], record.positions[::10], record.velocities[::10], record.loads[::10], 0.09, 0.7
    )
    with pytest.raises(ValueError, match="latency timer"):
        estimate([thin, thin])


def test_a_short_step_with_a_long_ramp_never_reaches_its_speed() -> None:
    way = reference(np.array([0.0, 10.0]), 0.1, Motion(0.0, 1.0, 1.0))
    assert way == pytest.approx([0.0, 0.1])
    middle = reference(np.array([np.sqrt(0.1)]), 0.1, Motion(0.0, 1.0, 1.0))
    assert middle[0] == pytest.approx(0.05)
