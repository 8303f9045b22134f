"""Frames and EMG as a session makes them, for measuring what records them."""

from random import Random

import numpy as np

from bentod.frames import (
    AssistFrame,
    Costs,
    EmgBlock,
    EmgFrame,
    Frame,
    Freshness,
    GroupFrame,
    JointFrame,
    JointSpec,
    Mode,
    StopReport,
    Velocity,
)

RATE = 30.0
"""Frames a second."""

EMG_RATE = 1000
CHANNELS = 8
BLOCKS = 30
"""EMG blocks a second."""

TICK = 2 * np.pi / 4096
"""rad; what a servo's position is a multiple of."""

JOINTS = ("shoulder_rotation", "shoulder_flexion", "elbow_flexion", "wrist_rotation", "wrist_flexion", "hand")
SPECS = tuple(JointSpec(name, -1.5, 1.5, 2.0, 0.0, {"id": i}) for i, name in enumerate((*JOINTS, "gripper")))


class Session:
    """Seven joints that move and are predicted, and eight channels of noise, from a seed."""

    def __init__(self, started: float = 0.0, wall: float = 1.7e9, seed: int = 1) -> None:
        self._random = Random(seed)
        self._noise = np.random.default_rng(seed)
        self._started, self._wall = started, wall

    def frame(self, tick: int) -> Frame:
        """The frame of one tick."""
        random = self._random
        due = self._started + tick / RATE
        age = random.uniform(0.001, 0.004)
        return Frame(
            tick=tick,
            time=due,
            wall=self._wall + tick / RATE + random.uniform(0, 1e-4),
            lateness=random.uniform(2e-5, 2e-4),
            missed=0,
            costs=Costs(*(random.uniform(1e-4, 4e-3) for _ in range(4))),
            shed=0,
            rate_hz=RATE,
            mode=Mode.ACTIVE,
            fault="",
            joints=tuple(self._joint(index, tick, age + 1e-4 * index) for index in range(len(SPECS))),
            emg=EmgFrame(
                True,
                False,
                "",
                tick * EMG_RATE // BLOCKS,
                random.uniform(0, 0.01),
                0,
                self._effort(),
                tick // 90,
            ),
            groups=(GroupFrame("arm", JOINTS[:4], JOINTS[1], random.uniform(-1, 1), "emg"),),
            assist=AssistFrame("dpcc", True, "", JOINTS[1]),
            goal=None,
            meta={"participant": "p07", "condition": "dpcc"},
            read_at=due + age,
        )

    def emg(self, block: int) -> EmgBlock:
        """One block of Gaussian noise, of which there are `BLOCKS` a second."""
        first, end = block * EMG_RATE // BLOCKS, (block + 1) * EMG_RATE // BLOCKS
        samples = self._noise.normal(0, 1e-4, (end - first, CHANNELS)).astype(np.float32)
        return EmgBlock(first, self._started + first / EMG_RATE, samples)

    def _effort(self) -> dict[str, float]:
        return {site: self._random.uniform(0, 1) for site in ("biceps", "triceps", "forearm")}

    def _joint(self, index: int, tick: int, age: float) -> JointFrame:
        random = self._random
        angle = float(np.sin(tick / 40 + index))
        speed = random.choice((0.3, -0.3, 0.25))
        sent = Velocity(speed) if index < 4 else None
        return JointFrame(
            name=SPECS[index].name,
            mode=Mode.ACTIVE,
            torque=True,
            position=round(angle / TICK) * TICK,
            velocity=round(float(np.cos(tick / 40 + index)) / 0.012) * 0.012,
            load=random.randrange(-100, 100) / 1023,
            voltage=12.0 + random.choice((0.0, 0.1)),
            temperature=40.0 + index,
            age=age,
            freshness=Freshness.FRESH,
            errors=(),
            stop=StopReport("full", 12.5 + index, 0.03125, 0.0),
            asked={"emg": Velocity(speed), "assist": Velocity(random.uniform(-1, 1))} if sent else {},
            holder="emg" if sent else "",
            sent=sent,
            limited="",
            predictions={"20": angle + random.uniform(-0.1, 0.1)} if index < 4 else {},
        )
