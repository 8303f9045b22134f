"""The config of an arm that does the tasks of chapter 5: two joints, the thesis' learners, and its assist."""

from dataclasses import dataclass
from typing import Literal

from bentod.config import Config
from bentod.config_learn import ARM, Learn
from bentod.config_tables import Record
from bentod.frames import Value
from sim.people.electrodes import FULL, THRESHOLD
from sim.people.scene import Point
from sim.studies.representations import seeing

GROUP = "arm"

SPEED = 0.2
"""rad/s of a joint at full effort (thesis 5.5): the assist is not held to it."""

TOP = 0.8
"""rad/s, what either joint may do at all."""


@dataclass(frozen=True, slots=True)
class Help:
    """The assist's settings; without change, those of the author's first session in appendix B."""

    timescale: float = 10.0  # steps
    k: float = 0.1  # of (5.1)
    mode: str = "dpcc"  # "off" leaves every circuit solo
    learned: tuple[float, ...] = ()  # further timescales (steps) that are predicted
    sees: str = ARM  # what positions are predicted from: "arm", or one of `SEEING`


MAZE_HELP = Help()
"""Appendix B, the author's first session."""

OURS = Help(timescale=25.0, mode="dpcc_confident")
"""Help that is gated by its confidence, with the defaults of its options."""

WAYPOINTS_HELP = Help(timescale=20.0, k=0.025)
"""Thesis 5.4."""


def configured(
    start: Point,
    limits: tuple[tuple[float, float], tuple[float, float]],
    help: Help,
    seed: int,
    driver: str,
    through: Literal["joystick", "emg"],
) -> Config:
    """The whole config; the assist is off until the session switches it on."""
    names, servos = ("shoulder_rotation", "elbow_flexion"), ("MX-64", "MX-106")
    joints: list[Value] = [
        {
            "name": names[i],
            "min_rad": limits[i][0],
            "max_rad": limits[i][1],
            "max_velocity_rad_s": TOP,
            "home_rad": start[i],
            "limits": {"soft_zone_rad": 0.03},
            "hardware": {"id": i + 1, "model": servos[i]},
        }
        for i in range(2)
    ]
    table: dict[str, Value] = {
        "arm": "Bento Arm (simulated)",
        "driver": {"name": driver, "seed": seed, "start_rad": dict(zip(names, start, strict=True))},
        "joints": joints,
        "groups": [{"name": GROUP, "joints": list(names)}],
        "safety": {"start": "active"},
        "assist": {"mode": "off", "group": GROUP, "timescale": help.timescale, "k": help.k},
    }
    if through == "emg":
        table["emg"] = _muscles()
    learn = learning(help, names)
    return Config.model_validate(table).model_copy(update={"learn": learn, "record": Record(enabled=False)})


def learning(help: Help, joints: tuple[str, str]) -> Learn:
    """The table [learn]: the thesis', but for what `help` says."""
    own = () if help.sees == ARM else (seeing(help.sees, joints, GROUP, SPEED, TOP),)
    timescales = tuple(sorted({help.timescale, *help.learned}))
    return Learn(joints=joints, timescales=timescales, representation=help.sees, representations=own)


def _muscles() -> Value:
    """Sites whose full contraction asks for `SPEED`, which leaves the top speed of joints to the assist."""
    most = THRESHOLD + (FULL - THRESHOLD) * TOP / SPEED
    sites: list[Value] = [
        {"name": name, "channel": channel, "threshold_v": THRESHOLD, "max_v": most}
        for channel, name in enumerate(("flexor", "extensor", "other_forearm"))
    ]
    pair: Value = {"group": GROUP, "positive": "flexor", "negative": "extensor", "toggle": "other_forearm"}
    return {"rate_hz": 200.0, "source": {"name": "synthetic"}, "sites": sites, "pairs": [pair]}
