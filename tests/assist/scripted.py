"""An arm of two joints under the daemon's own controller, and a script of who does what to it."""

import asyncio
from collections.abc import Callable, Sequence

from bentod import registry
from bentod.contracts import ArmConfig
from bentod.control.leases import Holder
from bentod.desk import Desk
from bentod.frames import Event, Frame, Mode, Value
from bentod.furnish import furnished
from bentod.inbox import Inbox
from bentod.start import Start
from bentod.tick import Controller
from sim.clock import VirtualClock, run
from sim.joints import SimulatedJoints
from sim.studies.session_config import GROUP, Help, configured

LIMITS = ((-0.8, 0.8), (-0.8, 0.8))
SHOULDER, ELBOW = 0, 1
USER = Holder(1, "joystick")


class Scene:
    """What a script may do after each tick; `time` is s since the arm was ready."""

    def __init__(self, inbox: Inbox, joints: SimulatedJoints) -> None:
        self._inbox = inbox
        self._joints = joints

    def ask(self, act: Callable[[Desk], object]) -> None:
        """On the seam before the next tick."""
        self._inbox.post(act)

    def push(self, effort: float) -> None:
        """The user asks this of the joint that is active."""
        self.ask(lambda desk: desk.group_command(GROUP, effort, USER, 0.2))

    def guide(self, positions: Sequence[float | None]) -> None:
        """A hand leads the joints there (rad), or lets go (None)."""
        for servo, position in zip(self._joints.arm.servos, positions, strict=True):
            servo.guided = position


Script = Callable[[float, Frame, Scene], None]


def play(script: Script, seconds: float, assist: dict[str, Value], help: Help) -> list[Frame]:
    """All frames of the script; `assist`: settings to begin with."""
    return run(_play(script, round(seconds * 30), assist, help))


async def _play(script: Script, ticks: int, assist: dict[str, Value], help: Help) -> list[Frame]:
    config = configured((0.0, 0.0), LIMITS, help, 1, "sim", "joystick")
    clock, inbox = VirtualClock(), Inbox()
    frames: list[Frame] = []
    specs = tuple(joint.spec() for joint in config.joints)
    arm = ArmConfig(specs, 1 / config.rate_hz, config.shares()[0].driver.options)
    async with registry.open_joints("sim")(arm, clock) as joints:
        assert isinstance(joints, SimulatedJoints)
        scene = Scene(inbox, joints)

        def publish(frame: Frame, events: Sequence[Event], whole: bool) -> None:
            if frames or frame.mode is Mode.ACTIVE:
                script(len(frames) / 30, frame, scene)
                frames.append(frame)

        desk = furnished(config, joints.torque(), None)
        desk.change_assist(assist)
        controller = Controller(joints, desk, inbox, clock, config.rate_hz, publish)
        starting = asyncio.create_task(Start(inbox, clock).run("active"))
        await controller.run(ticks)
        await starting
    return frames
