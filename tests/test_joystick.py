"""A joystick on an arm that does as it is told: what moves it, and all that must not."""

import math
from collections.abc import Mapping

import pytest

from bentod.config_joystick import Joystick as Table
from bentod.contracts import Pad
from bentod.control.leases import Holder
from bentod.frames import Command, Mode, Stop, Velocity
from bentod.joystick import Joystick
from sim.clock import VirtualClock
from sim.joystick import Options, SimPad
from tests.fakes import SPECS, Bench

SHOULDER, ELBOW = 0, 1
HALF = 0.5 * SPECS[SHOULDER].max_velocity  # rad/s; half of what each may do
HOLD, STOP, PAUSE, RELEASE, NEXT, BACK, OWN, TORQUE, MARK = range(9)
TABLE = {
    "source": {"name": "sim"},
    "dead_man": HOLD,
    "axes": [{"axis": 0, "group": "arm", "dead_zone": 0.0}, {"axis": 1, "joint": "elbow", "dead_zone": 0.0}],
    "buttons": [
        {"button": STOP, "action": "stop"},
        {"button": PAUSE, "action": "pause"},
        {"button": RELEASE, "action": "release"},
        {"button": NEXT, "action": "toggle", "group": "arm"},
        {"button": BACK, "action": "toggle_back", "group": "arm"},
        {"button": OWN, "action": "own_pause"},
        {"button": TORQUE, "action": "torque"},
        {"button": MARK, "action": "mark", "mark": "contact"},
    ],
}


class Played(Bench):
    """A released arm of shoulder and elbow, whose only operator is a joystick that was seen at rest."""

    def __init__(self, table: Mapping[str, object] = TABLE) -> None:
        super().__init__()
        self.pad = SimPad(Options(axes=2, buttons=9), VirtualClock())
        self.desk.joystick = Joystick(Table.model_validate(table), self.pad)
        self.desk.joystick.tell = lambda text, data: self.desk.journal.note("joystick", text, data)

    async def tick(self, ticks: int = 1) -> tuple[Command | None, ...]:
        """What the joints are told in the last of so many ticks."""
        await self.controller.run(ticks)
        return self.arm.sent[-1]

    async def push(self, effort: float = 0.5, axis: int = 0) -> tuple[Command | None, ...]:
        """Hold the dead man, then push."""
        self.pad.press(HOLD)
        await self.tick()
        self.pad.push(axis, effort)
        return await self.tick()

    def told(self, kind: str = "joystick") -> list[str]:
        return [event.text for event in self.events if event.kind == kind]

    def mode(self) -> Mode:
        return self.frames[-1].mode

    def problem(self) -> str:
        frame = self.frames[-1].joystick
        assert frame is not None
        return frame.problem


@pytest.fixture
async def played() -> Played:
    played = Played()
    await played.tick(2)
    return played


async def test_a_push_moves_the_active_joint_while_the_dead_man_is_held(played: Played) -> None:
    assert await played.push(0.5) == (Velocity(HALF), Stop())
    assert played.frames[-1].joints[SHOULDER].holder == "joystick"
    assert played.frames[-1].groups[0].operator == "joystick"
    assert await played.tick(20) == (Velocity(HALF), Stop())
    played.pad.press()
    assert await played.tick() == (Stop(), Stop())


async def test_without_the_dead_man_nothing_moves(played: Played) -> None:
    played.pad.push(0, 0.5)
    assert await played.tick(5) == (Stop(), Stop())


async def test_a_joint_is_driven_by_name(played: Played) -> None:
    assert await played.push(-0.5, axis=1) == (Stop(), Velocity(-HALF))
    assert played.frames[-1].joints[ELBOW].holder == "joystick"


async def test_a_pad_that_is_unplugged_asks_for_nothing_from_the_next_tick_on(played: Played) -> None:
    await played.push()
    played.pad.unplug()
    assert await played.tick() == (Stop(), Stop())
    assert played.problem() == "The simulated joystick is unplugged."
    assert played.told()[-1] == played.problem()


async def test_a_pad_that_comes_back_moves_nothing_before_it_was_seen_at_rest(played: Played) -> None:
    await played.push()
    played.pad.unplug()
    await played.tick()
    played.pad.plug()
    assert await played.tick(60) == (Stop(), Stop())
    assert "until every axis was at rest and button 0 was let go" in played.problem()
    played.pad.push(0, 0.0)
    await played.tick()
    assert await played.push() == (Stop(), Stop())  # the dead man has not been let go
    played.pad.push(0, 0.0)
    played.pad.press()
    await played.tick()
    assert await played.push() == (Velocity(HALF), Stop())
    assert played.told() == [
        "the joystick is there",
        "The simulated joystick is unplugged.",
        "the joystick is there",
    ]


async def test_a_pad_that_is_pushed_when_the_daemon_starts_moves_nothing() -> None:
    played = Played()
    played.pad.press(HOLD)
    played.pad.push(0, 0.5)
    assert await played.tick(30) == (Stop(), Stop())


async def test_a_driver_that_hangs_is_not_believed_for_long(played: Played) -> None:
    await played.push()
    played.pad.hung = True
    await played.tick(4)
    assert played.arm.sent[-1] == (Stop(), Stop())
    assert played.problem() == "The joystick's driver has given no sign of life for more than 0.1 s."


async def test_what_was_pressed_while_the_driver_hung_is_not_done_afterwards(played: Played) -> None:
    played.pad.hung = True
    await played.tick(5)
    played.pad.press(NEXT)
    await played.tick()
    played.pad.press()
    played.pad.hung = False
    await played.tick(3)
    assert played.frames[-1].groups[0].active == "shoulder"


@pytest.mark.parametrize("value", [math.nan, math.inf])
async def test_an_axis_that_is_no_number_moves_nothing_until_all_was_at_rest(
    played: Played, value: float
) -> None:
    await played.push()
    played.pad.push(0, value)
    assert await played.tick() == (Stop(), Stop())
    assert played.problem() == "Axis 0 of the joystick is not a finite number."
    played.pad.push(0, 0.5)
    assert await played.tick(5) == (Stop(), Stop())


async def test_a_pad_that_lacks_what_the_config_names_moves_nothing_and_says_so() -> None:
    played = Played({**TABLE, "axes": [{"axis": 4, "group": "arm"}]})
    await played.tick(2)
    assert await played.push() == (Stop(), Stop())
    assert played.problem() == "The joystick has no axis 4, which the config names."


async def test_a_driver_that_breaks_is_a_joystick_that_is_not_there(played: Played) -> None:
    class Broken:
        def latest(self) -> Pad:
            raise ZeroDivisionError("oops")

    played.desk.joystick = Joystick(Table.model_validate(TABLE), Broken())
    assert await played.tick(3) == (Stop(), Stop())
    assert played.problem() == "The joystick's driver broke: ZeroDivisionError: oops."
    assert played.frames[-1].fault == ""


async def test_a_push_of_which_nothing_changes_for_too_long_is_let_go(played: Played) -> None:
    await played.push()
    assert await played.tick(115) == (Velocity(HALF), Stop())
    assert await played.tick(10) == (Stop(), Stop())
    assert "nothing of the joystick has changed for 4 s" in played.told()[-1]


async def test_a_push_that_goes_on_changing_goes_on(played: Played) -> None:
    await played.push()
    for hundredth in range(300):
        played.pad.push(0, 0.5 - hundredth % 2 / 100)
        await played.tick()
    assert played.arm.sent[-1] == (Velocity(0.98 * HALF), Stop())


async def test_a_pause_acts_in_the_tick_in_which_its_button_is_pressed(played: Played) -> None:
    await played.push()
    played.pad.press(HOLD, PAUSE)
    assert await played.tick() == (Stop(), Stop())
    assert played.mode() is Mode.PAUSED
    assert played.frames[-1].joints[SHOULDER].asked["joystick"] == Velocity(HALF)


async def test_stop_needs_no_dead_man(played: Played) -> None:
    played.pad.press(STOP)
    await played.tick()
    assert played.mode() is Mode.PAUSED
    assert played.told("mode")[-1] == "stopped by the joystick"


async def test_a_release_needs_the_dead_man_and_then_the_stick_at_rest(played: Played) -> None:
    played.pad.press(PAUSE)
    await played.tick()
    played.pad.press(RELEASE)
    await played.tick()
    assert played.mode() is Mode.PAUSED
    assert played.told()[-1] == "not done: 'release': It needs button 0 held."
    played.pad.press()
    await played.tick()
    await played.push()
    played.pad.press(HOLD, RELEASE)
    assert await played.tick(10) == (Stop(), Stop())
    assert played.mode() is Mode.ACTIVE
    played.pad.push(0, 0.0)
    await played.tick()
    played.pad.push(0, 0.5)
    assert await played.tick() == (Velocity(HALF), Stop())


async def test_what_the_arm_refuses_is_told_and_breaks_nothing(played: Played) -> None:
    played.desk.fault("a test")
    await played.tick()
    for button in (RELEASE, TORQUE):
        played.pad.press(HOLD)
        await played.tick()
        played.pad.press(HOLD, button)
        await played.tick()
    told = played.told()[-2:]
    assert [text.partition(": ")[2].partition(":")[0] for text in told] == ["'release'", "'torque'"]
    assert all("a fault is latched" in text for text in told)
    assert played.frames[-1].fault == "a test"


async def test_buttons_toggle_both_ways_without_the_dead_man(played: Played) -> None:
    played.pad.press(NEXT)
    await played.tick(3)
    assert played.frames[-1].groups[0].active == "elbow"
    played.pad.press(BACK)
    await played.tick()
    assert played.frames[-1].groups[0].active == "shoulder"


async def test_in_its_own_pause_it_asks_for_nothing_but_can_still_stop_the_arm(played: Played) -> None:
    await played.push()
    played.pad.press(HOLD, OWN)
    assert await played.tick() == (Stop(), Stop())
    assert played.told()[-1] == "the joystick is paused"
    assert played.mode() is Mode.ACTIVE
    played.pad.press(HOLD, NEXT)
    assert await played.tick() == (Stop(), Stop())
    assert played.frames[-1].groups[0].active == "shoulder"
    played.pad.press(HOLD, STOP)
    await played.tick()
    assert played.mode() is Mode.PAUSED


async def test_when_its_own_pause_ends_it_must_be_seen_at_rest(played: Played) -> None:
    played.pad.press(OWN)
    await played.tick()
    played.pad.press()
    await played.push()
    played.pad.press(HOLD, OWN)
    assert await played.tick(5) == (Stop(), Stop())
    played.pad.press()
    played.pad.push(0, 0.0)
    await played.tick()
    assert await played.push() == (Velocity(HALF), Stop())


@pytest.mark.parametrize("axis", [0, 1])
async def test_a_client_is_stronger_and_nothing_jumps_when_it_leaves(played: Played, axis: int) -> None:
    joint = (SHOULDER, ELBOW)[axis]
    await played.push(axis=axis)
    holder = Holder(1, "ann")
    played.inbox.post(lambda desk: desk.move(joint, Velocity(-0.05), holder, 0.2))
    assert (await played.tick())[joint] == Velocity(-0.05)
    assert (await played.tick(30))[joint] == Stop()
    played.pad.push(axis, 0.0)
    await played.tick()
    played.pad.push(axis, 0.5)
    assert (await played.tick())[joint] == Velocity(HALF)


async def test_a_group_whose_active_joint_is_driven_by_name_is_taken(played: Played) -> None:
    played.pad.press(NEXT)
    await played.tick()
    await played.push(0.5, axis=1)
    played.pad.push(0, -1.0)
    (_, elbow) = await played.tick(5)
    assert isinstance(elbow, Velocity)
    assert elbow.velocity > 0


async def test_a_mark_is_told_and_needs_neither_trial_nor_dead_man(played: Played) -> None:
    played.pad.press(MARK)
    await played.tick(2)
    assert played.told("mark") == ["the joystick marked: contact"]


async def test_presses_that_may_be_old_only_restrain(played: Played) -> None:
    joystick = played.desk.joystick
    assert joystick is not None
    now = VirtualClock().now()
    played.pad.press(NEXT, PAUSE)
    push = joystick.look(now, held_up=True)
    assert [button.action for button in push.pressed] == ["pause"]
    assert not push.asked.toggles


async def test_the_frame_tells_what_is_pushed_and_whether_it_counts(played: Played) -> None:
    await played.push(0.5)
    frame = played.frames[-1].joystick
    assert frame is not None
    assert (frame.connected, frame.paused, frame.problem, frame.held) == (True, False, "", True)
    assert frame.axes == {"0": 0.5, "1": 0.0}
