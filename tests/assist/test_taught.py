"""What an arm is taught by hand, and what it expects of its user's effort, it does through the controller."""

import asyncio
from pathlib import Path

import pytest

from bentod.frames import Frame, Mode, Value, Velocity
from sim.studies.session_config import Help
from tests.assist.scripted import ELBOW, SHOULDER, Scene, play
from tests.rig import PLAIN, Table, number, running, sim_config, table, wait_for

TEACHING = 36.0  # s
ROUND = 6.0  # s, there and back


def swing(time: float) -> float:
    """Where a shoulder is that goes to and fro between -0.3 and 0.3 rad at 0.2 rad/s."""
    phase = time % ROUND / ROUND
    return 0.3 - 1.2 * abs(phase - 0.5) if phase else -0.3


def by_hand(taught: bool) -> list[Frame]:
    """A limp arm is led along elbow = 0.8 shoulder, or held at rest; then the user moves the shoulder."""

    def script(time: float, frame: Frame, scene: Scene) -> None:
        if time < TEACHING:
            if time < 0.2:
                scene.ask(lambda desk: desk.torque([0, 1], False))
            if frame.mode is Mode.LIMP:
                scene.guide([swing(time), 0.8 * swing(time)] if taught else [-0.3, -0.24])
        elif time < TEACHING + 1.5:
            scene.guide([-0.3, -0.24] if time < TEACHING + 1 else [None, None])
            if abs(time - TEACHING - 0.5) < 0.01:
                scene.ask(lambda desk: desk.torque([0, 1], True))
            if abs(time - TEACHING - 1.0) < 0.01:
                scene.ask(lambda desk: desk.pause([0, 1], False))
        elif frame.joints[SHOULDER].position < 0.25:
            scene.push(0.25)

    help_ = Help(timescale=10.0, k=0.1)
    return play(script, TEACHING + 4.5, {"mode": "dpcc", "manual_after_toggle_s": 0.0}, help_)


def test_what_was_learned_while_a_limp_arm_was_led_by_hand_is_followed_afterwards() -> None:
    frames = by_hand(taught=True)
    during = [frame for frame in frames if frame.mode is Mode.LIMP]
    assert len(during) > 0.9 * TEACHING * 30
    assert max(frame.joints[ELBOW].position for frame in during) == pytest.approx(0.24, abs=0.08)
    asked = [frame.joints[ELBOW].asked.get("assist") for frame in frames[round((TEACHING + 1.5) * 30) :]]
    assert sum(isinstance(wish, Velocity) and wish.velocity > 0 for wish in asked) > 20
    shoulder, elbow = (frames[-1].joints[joint].position for joint in (SHOULDER, ELBOW))
    assert shoulder > 0.2
    assert elbow == pytest.approx(0.8 * shoulder, abs=0.1)


def test_an_arm_that_was_only_held_leaves_the_elbow_where_it_is() -> None:
    frames = by_hand(taught=False)
    assert frames[-1].joints[SHOULDER].position > 0.2
    assert frames[-1].joints[ELBOW].position < -0.1


def test_a_joint_moves_with_the_effort_that_its_user_is_expected_to_make() -> None:
    def script(time: float, frame: Frame, scene: Scene) -> None:
        """Up with both joints in turn, half a second each, and down again."""
        tick = round(time * 30)
        if tick % 15 == 0:
            scene.ask(lambda desk: desk.toggle("arm", 1, "joystick"))
        scene.push(0.25 if time % 8 < 4 else -0.25)

    settings: dict[str, Value] = {"mode": "effort", "manual_after_toggle_s": 0.0}
    frames = play(script, 64.0, settings, Help(timescale=10.0))
    told = frames[-1].learn.predictions
    assert told.keys() == {"arm.effort_of.shoulder_rotation@10", "arm.effort_of.elbow_flexion@10"}
    late = frames[-960:]
    for up, phase in ((1, 2.0), (-1, 6.0)):
        moved = [
            wish.velocity
            for place, frame in enumerate(late, len(frames) - 960)
            if abs(place / 30 % 8 - phase) < 1
            for joint in frame.joints
            if isinstance(wish := joint.asked.get("assist"), Velocity)
        ]
        assert len(moved) > 40
        assert up * sum(moved) / len(moved) > 0.03
    assert frames[-1].assist.mode == "effort"


EFFORTS = """
[[learn.gvfs]]
name = "{cumulant}@{timescale}"
cumulant = ["arm.effort", "emg.flexor"]
timescale = 15

[assist]
"""


async def test_effort_and_muscles_are_predicted_like_joints_and_told_in_frames(tmp_path: Path) -> None:
    config = sim_config(PLAIN, ("[assist]\n", EFFORTS))
    seen: list[Table] = []
    async with running(config, tmp_path / "bentod.sock") as arm:
        await asyncio.sleep(15)
        frame = await wait_for(arm, lambda frame: "flexor" in table(table(frame["emg"])["effort"]))
        async with arm.listen("state", 100) as frames:
            async for frame in frames:
                seen.append(frame)
                if len(seen) == 300:
                    break
    told = [table(table(frame["learn"])["predictions"]) for frame in seen]
    expected = [number(predictions, "emg.flexor@15") for predictions in told]
    active = [number(table(table(frame["emg"])["effort"]), "flexor") for frame in seen]
    assert max(expected) > 0.5 > 0.2 > min(expected)
    assert max(active) > 0.9
    assert {"arm.effort@15", "emg.flexor@15"} <= told[-1].keys()
