"""What every arm must do, whatever drives it; a new driver adds one parameter to `OPENERS`.

A driver of something else than servos runs the suite under an `opener` fixture of its own, as
`test_can_joints` does. `test_real_joints` has what can be asked of an arm that cannot be broken.
"""

from collections.abc import AsyncIterator, Callable, Mapping, Sequence
from contextlib import AbstractAsyncContextManager, asynccontextmanager
from dataclasses import replace
from itertools import pairwise
from math import degrees, radians
from typing import Protocol, TypeAlias

import pytest

from bentod.contracts import ArmConfig, Clock, FaultInjector, Joints
from bentod.errors import BadRequest, BusError
from bentod.frames import Command, Freshness, Position, State, Stop, Value, Velocity
from sim.bento import bento_joints
from sim.clock import VirtualClock
from sim.joints import open_joints, open_plain_joints
from tests.fakes import cleared

PERIOD = 1 / 30
DEAD_MAN = 0.35
"""s: what drivers allow by default without an order, 0.3, and a servo's dead time."""
JOINTS = bento_joints()
SHOULDER, ELBOW, WRIST_ROTATION, WRIST_FLEXION, GRIPPER = range(5)
START = {"shoulder_rotation": -0.4, "elbow_flexion": 0.1, "wrist_rotation": 0.3, "gripper": 0.5}
FREE = (SHOULDER, WRIST_ROTATION, GRIPPER)
"""Joints on which gravity does not pull."""


class BreakableJoints(Joints, FaultInjector, Protocol):
    """What the suite is run against."""


Opener: TypeAlias = Callable[[ArmConfig, Clock], AbstractAsyncContextManager[BreakableJoints]]


def with_servos(opener: Opener, *models: str) -> Opener:
    """The same arm made of other servos."""

    @asynccontextmanager
    async def open_with(config: ArmConfig, clock: Clock) -> AsyncIterator[BreakableJoints]:
        joints = tuple(
            replace(spec, hardware={**spec.hardware, "model": model})
            for spec, model in zip(config.joints, models, strict=True)
        )
        async with opener(replace(config, joints=joints), clock) as opened:
            yield opened

    return open_with


FIRMWARE_2 = ("MX-64(2.0)", "MX-106(2.0)", "MX-28(2.0)", "MX-28(2.0)", "MX-28(2.0)")
MIXED = ("MX-64(2.0)", "MX-106", "AX-12A", "MX-28(2.0)", "MX-28")

OPENERS = [
    pytest.param(open_plain_joints, id="servo models"),
    pytest.param(with_servos(open_plain_joints, *MIXED), id="servo models of all kinds"),
    pytest.param(open_joints, id="driver over a simulated bus"),
    pytest.param(with_servos(open_joints, *FIRMWARE_2), id="driver over protocol 2.0"),
    pytest.param(with_servos(open_joints, *MIXED), id="driver over both protocols on one line"),
]


class Rig:
    """An arm, ticked as the daemon ticks it."""

    def __init__(self, joints: BreakableJoints, clock: VirtualClock) -> None:
        self.joints = joints
        self.clock = clock
        self.wanted: list[Command | None] = [None] * len(JOINTS)
        self.states: list[State] = []

    async def tick(self) -> State:
        """Read, write what is wanted, and wait for the next tick."""
        began = self.clock.now()
        self.states.append(await self.joints.read())
        assert self.clock.now() - began < PERIOD
        await self.joints.write(self.wanted)
        await self.clock.sleep_until(began + PERIOD)
        return self.states[-1]

    async def run(self, seconds: float) -> State:
        """Tick for a while; returns the last state, `states` holds all of this run."""
        self.states.clear()
        for _ in range(max(round(seconds / PERIOD), 1)):
            await self.tick()
        return self.states[-1]

    async def torque_on(self, *which: int) -> State:
        """Switch on (all joints without `which`), stopped."""
        chosen = which or tuple(range(len(JOINTS)))
        await self.joints.set_torque([i in chosen for i in range(len(JOINTS))])
        self.want({i: Stop() for i in chosen})
        return await self.run(0.5)

    def want(self, commands: Mapping[int, Command | None]) -> None:
        """Change what is wanted of some joints."""
        for joint, command in commands.items():
            self.wanted[joint] = command

    def track(self, joint: int) -> list[float]:
        """Positions in the last run, rad."""
        return [state.joints[joint].position for state in self.states]


def need(rig: Rig, fault: str) -> None:
    """Leave out a test of something that this hardware cannot have."""
    if fault not in rig.joints.faults():
        pytest.skip(f"has no fault '{fault}'")


@pytest.fixture(params=OPENERS)
def opener(request: pytest.FixtureRequest) -> Opener:
    found: Opener = request.param
    return found


@asynccontextmanager
async def opened(opener: Opener, clock: VirtualClock, **options: Value) -> AsyncIterator[Rig]:
    starts: dict[str, Value] = dict(START)
    async with opener(
        ArmConfig(JOINTS, PERIOD, {"start_rad": starts, "seed": 1, **options}), clock
    ) as joints:
        yield Rig(joints, clock)


@pytest.fixture
async def rig(opener: Opener, clock: VirtualClock) -> AsyncIterator[Rig]:
    async with opened(opener, clock) as found:
        yield found


def positions(state: State) -> list[float]:
    return [joint.position for joint in state.joints]


def speed_over(track: Sequence[float]) -> float:
    """rad/s over a run, the first third left out."""
    later = track[len(track) // 3 :]
    return (later[-1] - later[0]) / ((len(later) - 1) * PERIOD)


async def test_a_reading_is_fresh_young_and_in_radians(rig: Rig) -> None:
    state = await rig.tick()
    assert all(joint.freshness is Freshness.FRESH and 0 <= joint.age < 0.02 for joint in state.joints)
    assert [state.joints[i].position for i in FREE] == pytest.approx([-0.4, 0.3, 0.5], abs=0.003)
    assert state.problem == ""


async def test_a_reading_says_when_it_ended(rig: Rig) -> None:
    before = rig.clock.now()
    state = await rig.joints.read()
    assert before <= state.time <= rig.clock.now()


async def test_an_arm_at_rest_shows_volts_degrees_and_no_complaint(rig: Rig) -> None:
    for joint in (await rig.run(2.0)).joints:
        assert joint.voltage == pytest.approx(12.0, abs=0.2)
        assert joint.temperature == pytest.approx(25.0, abs=2.0)
        assert joint.velocity == joint.load == 0.0
        assert joint.errors == ()


async def test_an_arm_is_found_limp(rig: Rig) -> None:
    assert rig.joints.torque() == (False,) * 5


async def test_torque_on_pins_every_joint_where_it_is(rig: Rig) -> None:
    before = positions(await rig.run(2.0))
    await rig.joints.set_torque([True] * 5)
    assert rig.joints.torque() == (True,) * 5
    await rig.run(1.0)
    for joint, start in enumerate(before):
        assert max(abs(degrees(p - start)) for p in rig.track(joint)) < 1.0


async def test_torque_on_forgets_the_goals_of_the_past(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({GRIPPER: Position(0.0, 1.0)})
    await rig.run(0.2)
    await rig.joints.set_torque([False] * 5)
    rig.want(dict.fromkeys(range(5)))
    before = (await rig.run(1.0)).joints[GRIPPER].position
    await rig.torque_on(GRIPPER)
    assert degrees((await rig.run(1.0)).joints[GRIPPER].position - before) == pytest.approx(0, abs=1.0)


@pytest.mark.parametrize("velocity", [0.3, -0.3])
@pytest.mark.parametrize("joint", range(5))
async def test_a_velocity_moves_a_joint_at_about_that_velocity(rig: Rig, joint: int, velocity: float) -> None:
    await rig.torque_on()
    rig.want({joint: Position(0.2, 1.0)})
    await rig.run(1.2)
    rig.want({joint: Velocity(velocity)})
    state = await rig.run(0.8)
    assert speed_over(rig.track(joint)) == pytest.approx(velocity, rel=0.1)
    assert state.joints[joint].velocity == pytest.approx(velocity, rel=0.15)


async def test_the_smallest_velocity_creeps(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({GRIPPER: Velocity(1e-6)})
    await rig.run(1.0)
    assert 0 <= rig.track(GRIPPER)[-1] - 0.5 < radians(1.5)


@pytest.mark.parametrize("velocity", [0.8, -0.8])
async def test_a_velocity_ends_at_the_limit(rig: Rig, velocity: float) -> None:
    await rig.torque_on()
    rig.want({joint: Velocity(velocity) for joint in range(5)})
    state = await rig.run(5.5)
    for spec, joint in zip(JOINTS, state.joints, strict=True):
        limit = spec.maximum if velocity > 0 else spec.minimum
        assert joint.position == pytest.approx(limit, abs=radians(1.5))


@pytest.mark.parametrize("velocity", [0.5, -0.5])
async def test_a_stop_ends_motion_at_once_without_a_jump_back(rig: Rig, velocity: float) -> None:
    await rig.torque_on()
    rig.want(dict.fromkeys(range(5), Position(0.2, 1.0)))
    await rig.run(3.0)
    rig.want(dict.fromkeys(range(5), Velocity(velocity)))
    await rig.run(0.6)
    rig.want(dict.fromkeys(range(5), Stop()))
    await rig.run(0.4)
    for joint in range(5):
        track = [p * (1 if velocity > 0 else -1) for p in rig.track(joint)]
        assert track[-1] - track[0] < radians(5)
        assert max(track) - track[-1] < radians(1.0)
        assert max(track[-4:]) - min(track[-4:]) < radians(0.2)


async def test_repeated_stops_do_not_move_a_joint(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({ELBOW: Velocity(0.4)})
    await rig.run(0.5)
    rig.want({ELBOW: Stop()})
    await rig.run(0.5)
    await rig.run(5.0)
    assert max(rig.track(ELBOW)) - min(rig.track(ELBOW)) < radians(0.2)


async def test_a_position_is_reached_no_faster_than_asked(rig: Rig) -> None:
    await rig.torque_on()
    targets = {SHOULDER: 0.6, ELBOW: 0.5, WRIST_ROTATION: -0.6, WRIST_FLEXION: 0.2, GRIPPER: 0.9}
    rig.want({joint: Position(target, 0.4) for joint, target in targets.items()})
    state = await rig.run(6.0)
    for joint, target in targets.items():
        assert state.joints[joint].position == pytest.approx(target, abs=radians(1.5))
    track = rig.track(SHOULDER)
    assert max(b - a for a, b in pairwise(track)) < 0.4 * PERIOD * 1.5


async def test_a_limp_joint_sags_while_others_are_driven(rig: Rig) -> None:
    await rig.torque_on(SHOULDER)
    rig.want({SHOULDER: Velocity(0.3)})
    state = await rig.run(1.0)
    assert rig.joints.torque() == (True, False, False, False, False)
    assert state.joints[ELBOW].position < JOINTS[ELBOW].minimum + 0.01
    assert state.joints[GRIPPER].position == pytest.approx(0.5, abs=0.002)
    assert state.joints[ELBOW].load == 0.0


async def test_torque_off_lets_the_arm_down(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({ELBOW: Position(0.3, 0.5)})
    await rig.run(3.0)
    rig.want(dict.fromkeys(range(5)))
    await rig.joints.set_torque([False] * 5)
    assert rig.joints.torque() == (False,) * 5
    assert (await rig.run(1.0)).joints[ELBOW].position < 0.0


async def test_a_silent_joint_goes_stale_then_lost_and_comes_back(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("silent", WRIST_ROTATION, True)
    await rig.run(1.5)
    seen = [state.joints[WRIST_ROTATION] for state in rig.states]
    assert seen[1].freshness is Freshness.STALE
    assert seen[-1].freshness is Freshness.LOST
    ages = [joint.age for joint in seen]
    assert ages == sorted(ages)
    assert ages[-1] == pytest.approx(1.5, abs=0.1)
    rig.joints.inject("silent", WRIST_ROTATION, False)
    await rig.run(4.0)
    assert all(joint.freshness is Freshness.FRESH for joint in rig.states[-1].joints)


@pytest.mark.parametrize("joint", [SHOULDER, GRIPPER])
async def test_a_joint_that_was_silent_for_a_while_obeys_again_or_says_why_not(rig: Rig, joint: int) -> None:
    await rig.torque_on()
    rig.joints.inject("silent", joint, True)
    await rig.run(0.7)
    rig.joints.inject("silent", joint, False)
    before = (await rig.run(1.5)).joints[joint]
    rig.want({joint: Velocity(0.3)})
    after = (await rig.run(1.5)).joints[joint]
    assert after.position > before.position + 0.2 or after.errors or not rig.joints.torque()[joint]


async def test_what_is_not_fresh_is_older_than_a_round(rig: Rig) -> None:
    rig.joints.inject("silent", ELBOW, True)
    await rig.run(1.0)
    for state in rig.states:
        for joint in state.joints:
            assert joint.freshness is not Freshness.FRESH or joint.age < PERIOD


async def test_joints_before_a_silent_one_stay_fresh(rig: Rig) -> None:
    rig.joints.inject("silent", WRIST_ROTATION, True)
    await rig.run(1.0)
    assert all(state.joints[SHOULDER].freshness is Freshness.FRESH for state in rig.states)
    assert all(state.joints[ELBOW].freshness is Freshness.FRESH for state in rig.states)


async def test_torque_of_a_silent_joint_is_not_confirmed(rig: Rig) -> None:
    rig.joints.inject("silent", ELBOW, True)
    with pytest.raises(BusError, match="elbow_flexion"):
        await rig.joints.set_torque([True] * 5)
    assert rig.joints.torque() == (True, False, True, True, True)


async def test_a_pulled_cable_loses_every_joint_and_says_why(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({SHOULDER: Velocity(0.2)})
    await rig.run(0.5)
    rig.joints.inject("cable", None, True)
    state = await rig.run(1.0)
    assert all(joint.freshness is Freshness.LOST for joint in state.joints)
    assert all(state.joints[0].freshness is not Freshness.FRESH for state in rig.states)
    assert state.problem.endswith(".")
    with pytest.raises(BusError):
        await rig.joints.set_torque([False] * 5)


async def test_a_noisy_line_never_raises_and_mostly_answers(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("noise", None, True)
    rig.want(dict.fromkeys(FREE, Velocity(0.05)))
    await rig.run(10.0)
    fresh = [joint.freshness is Freshness.FRESH for state in rig.states for joint in state.joints]
    assert sum(fresh) > 0.5 * len(fresh)
    for joint, spec in enumerate(JOINTS):
        assert all(spec.minimum - 0.05 < p < spec.maximum + 0.05 for p in rig.track(joint))


@pytest.mark.parametrize(
    ("fault", "complaint"), [("overload", "Overload"), ("overheat", "Overheat"), ("low_voltage", "Voltage")]
)
async def test_a_servo_in_trouble_is_still_read_and_says_so(rig: Rig, fault: str, complaint: str) -> None:
    rig.joints.inject(fault, GRIPPER, True)
    joint = (await rig.run(0.1)).joints[GRIPPER]
    assert joint.freshness is Freshness.FRESH
    assert any(complaint in error for error in joint.errors)


async def test_a_stuck_joint_shows_load_and_no_motion(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("stuck", GRIPPER, True)
    rig.want({GRIPPER: Velocity(-0.5)})
    state = await rig.run(1.0)
    assert state.joints[GRIPPER].position == pytest.approx(0.5, abs=radians(1.0))
    assert state.joints[GRIPPER].load < -0.5


async def test_power_comes_back_with_torque_off(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("power", None, True)
    await rig.run(1.0)
    rig.joints.inject("power", None, False)
    rig.want(dict.fromkeys(range(5)))
    await rig.run(4.0)
    assert rig.joints.torque() == (False,) * 5


@pytest.mark.parametrize("joint", [SHOULDER, WRIST_ROTATION, GRIPPER])
async def test_a_servo_that_starts_anew_in_mid_motion_is_limp_and_not_armed_again(
    rig: Rig, joint: int
) -> None:
    need(rig, "reboot")
    await rig.torque_on()
    rig.want({joint: Velocity(-0.2)})
    await rig.run(0.5)
    rig.joints.inject("reboot", joint, True)
    await rig.run(2.0)
    assert any(state.joints[joint].freshness is not Freshness.FRESH for state in rig.states)
    assert rig.joints.torque() == tuple(i != joint for i in range(5))
    await rig.run(1.0)
    assert max(rig.track(joint)) == min(rig.track(joint))
    assert all(state.joints[joint].load == 0.0 for state in rig.states)


async def test_nobody_talking_any_more_lets_a_motion_end_soon(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({SHOULDER: Velocity(0.3), WRIST_ROTATION: Velocity(-0.3), GRIPPER: Velocity(0.3)})
    await rig.run(0.8)
    await rig.clock.sleep_until(rig.clock.now() + DEAD_MAN)
    stopped = positions(await rig.joints.read())
    await rig.clock.sleep_until(rig.clock.now() + 3.0)
    assert positions(await rig.joints.read()) == pytest.approx(stopped, abs=radians(0.3))


async def test_an_overload_can_be_cleared_and_the_joint_moves_again(rig: Rig) -> None:
    await rig.torque_on()
    rig.joints.inject("overload", GRIPPER, True)
    assert (await rig.run(0.3)).joints[GRIPPER].errors
    rig.want(dict.fromkeys(range(5)))
    where = rig.track(GRIPPER)[-1]
    assert await cleared(rig.joints, [GRIPPER]) == ()
    state = await rig.run(1.5)
    assert state.joints[GRIPPER].errors == ()
    assert state.joints[GRIPPER].position == pytest.approx(where, abs=radians(1))
    await rig.torque_on()
    rig.want({GRIPPER: Velocity(-0.3)})
    await rig.run(1.0)
    assert rig.track(GRIPPER)[-1] < where - 0.2


async def test_a_servo_that_is_still_hot_is_not_cleared_and_says_so(rig: Rig) -> None:
    rig.joints.inject("overheat", GRIPPER, True)
    await rig.run(0.3)
    (sentence,) = await cleared(rig.joints, [GRIPPER])
    assert "gripper" in sentence
    assert sentence.endswith(".")
    assert (await rig.run(1.5)).joints[GRIPPER].errors


async def test_clearing_nothing_but_good_joints_changes_nothing(rig: Rig) -> None:
    await rig.torque_on()
    rig.want({SHOULDER: Stop()})
    assert await cleared(rig.joints, [SHOULDER, GRIPPER]) == ()
    await rig.run(1.5)
    assert all(not joint.errors for joint in rig.states[-1].joints)
    assert rig.joints.torque()[ELBOW]


async def test_errors_of_a_silent_joint_are_not_cleared_which_is_said(rig: Rig) -> None:
    rig.joints.inject("silent", GRIPPER, True)
    await rig.run(0.5)
    (sentence,) = await cleared(rig.joints, [GRIPPER])
    assert sentence.endswith(".")


async def test_errors_behind_a_pulled_cable_are_not_cleared_which_is_said(rig: Rig) -> None:
    rig.joints.inject("cable", None, True)
    await rig.run(0.2)
    assert await cleared(rig.joints, [SHOULDER, GRIPPER])


async def test_a_cable_that_is_plugged_in_again_finds_the_same_arm(rig: Rig) -> None:
    await rig.torque_on(SHOULDER, WRIST_ROTATION, GRIPPER)
    before = positions(await rig.run(0.5))
    rig.joints.inject("cable", None, True)
    await rig.run(1.0)
    rig.joints.inject("cable", None, False)
    state = await rig.run(10.0)
    assert state.problem == ""
    assert all(joint.freshness is Freshness.FRESH for joint in state.joints)
    assert [state.joints[i].position for i in FREE] == pytest.approx([before[i] for i in FREE], abs=0.02)
    assert rig.joints.torque() == (True, False, True, False, True)


async def test_unknown_faults_are_refused(rig: Rig) -> None:
    assert {"cable", "silent", "stuck"} <= set(rig.joints.faults())
    with pytest.raises(BadRequest):
        rig.joints.inject("boredom", None, True)


async def test_the_same_seed_gives_the_same_arm(opener: Opener, clock: VirtualClock) -> None:
    async def story() -> list[float]:
        async with opened(opener, clock, seed=7) as rig:
            await rig.torque_on()
            rig.want({SHOULDER: Velocity(0.3), ELBOW: Velocity(-0.1)})
            return positions(await rig.run(0.5))

    assert await story() == pytest.approx(await story(), abs=1e-3)
