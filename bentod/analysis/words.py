"""The data dictionary: the unit and the meaning of every value of a tick, by its path in the frame."""

from typing import NamedTuple


class Word(NamedTuple):
    """What a column holds."""

    unit: str  # "" for a name, a flag, a count or a share
    meaning: str


SUFFIXES = {
    "rad": "_rad",
    "rad/s": "_rad_s",
    "s": "_s",
    "V": "_v",
    "°C": "_c",
    "Hz": "_hz",
    "steps": "_steps",
}
"""How a unit ends a column's name."""

UNKNOWN = Word("", "a value that this version of the data dictionary does not describe")

FRAME = {
    "tick": Word("", "number of the tick since the daemon started"),
    "time": Word("s", "monotonic time of the tick's deadline"),
    "wall": Word("s", "wall time, since 1970-01-01 UTC"),
    "lateness": Word("s", "from the deadline to the start of the tick"),
    "missed": Word("", "ticks skipped since the daemon started"),
    "shed": Word("", "updates of learners left out since the start, because their ticks' time was spent"),
    "rate_hz": Word("Hz", "ticks a second"),
    "mode": Word("", "'fault', or the mode of the least restrained joint"),
    "fault": Word("", "why the arm is in fault; empty when it is not"),
    "gap": Word("", "whether ticks just before it were missed or broke"),
    "read_at": Word("s", "monotonic time of the end of the round on the bus"),
    "whole": Word("", "whether the tick ran to its end; false: it broke and only told of the fault"),
}

COSTS = {
    "read": Word("s", "what the round on the bus took"),
    "think": Word("s", "what muscles, learners, assist, arbiter and limits took"),
    "write": Word("s", "what commands and torque took"),
    "publish": Word("s", "what sending the frame of the tick before took"),
}

TRIAL = {
    "number": Word("", "number of the running trial, from 1; empty (npz: −1) between trials"),
    "name": Word("", "name of the running trial"),
    "condition": Word("", "condition of the running trial"),
    "started": Word("s", "monotonic time at which the trial started"),
}

EMG = {
    "alive": Word("", "whether the muscle signals could move the arm"),
    "paused": Word("", "whether the muscles were kept from driving anything"),
    "problem": Word("", "why the source was not alive"),
    "next_index": Word("", "index after the newest sample that the tick knew"),
    "age": Word("s", "since the newest sample"),
    "dropped": Word("", "samples lost since the source was opened"),
    "toggles": Word("", "toggles by the muscles since the start"),
}

RECOGNITION = Word("", "JSON of the newest decision of pattern recognition; empty if there is none")

JOYSTICK = Word("", "JSON of the joystick: its axes, and why it moves nothing; empty if there is none")

EFFORT = Word("", "effort of the site, 0..1")

GROUP = {
    "active": Word("", "the joint that the operator attends to"),
    "effort": Word("", "what the operator asks of the active joint, −1..1, as a share of its top speed"),
    "operator": Word("", "who drives the group"),
    "together": Word("", "whether all its joints at once are selected"),
}

ASSIST = {
    "mode": Word("", "which collaborative control"),
    "engaged": Word("", "whether it moves or would move a joint"),
    "reason": Word("", "why it does or does not"),
    "attended": Word("", "the joint that the operator is moving, as the assist sees it"),
    "group": Word("", "the group that it helps with"),
    "offers_together": Word("", "whether all joints of its group at once may be selected"),
}

MOVING = Word("", "JSON of the velocities (rad/s) that the assist asks of joints; empty if of none")

MORE_ASSISTS = Word("", "JSON of the assists of further groups; empty if there are none")

OLDER = Word("", "JSON of the ticks since predictions were made that are not of this one; empty as a rule")

LEARN = {
    "predictions": Word("", "what a general value function of one's own predicts, in its cumulant's unit"),
    "confidence": Word("", "C of a prediction: none at 0, all at 1"),
    "surprise": Word("", "Z of a prediction: its recent errors beside their usual spread"),
    "error": Word("", "running RMSE of a prediction against the return, in its cumulant's unit"),
    "familiarity": Word("", "how well a state is known by a representation, 0..1"),
}

GOAL = {
    "id": Word("", "number of the goal; empty (npz: −1) when there is none"),
    "kind": Word("", "what kind of goal"),
    "status": Word("", "accepted, moving, done or cancelled"),
    "progress": Word("", "share that is done, 0..1"),
    "reason": Word("", "why it was cancelled"),
}

JOINT = {
    "mode": Word("", "what the joint was allowed to do"),
    "torque": Word("", "whether it had torque"),
    "position": Word("rad", "position as read"),
    "velocity": Word("rad/s", "velocity as read"),
    "load": Word("", "share of the greatest torque, −1..1"),
    "voltage": Word("V", "supply voltage at the servo"),
    "temperature": Word("°C", "temperature of the servo"),
    "age": Word("s", "from the sampling of the reading to the end of the round"),
    "freshness": Word("", "fresh, stale or lost"),
    "holder": Word("", "the source that won, or the mode that stopped the joint; empty when nobody asked"),
    "limited": Word("", "which limit made what was sent differ from what was asked"),
}

STOP = {
    "rule": Word("", "how the resting place of the last stop was estimated"),
    "time": Word("s", "monotonic time at which the joint was told to stop"),
    "travel": Word("rad", "way from there to where it came to rest"),
    "bounce": Word("rad", "how far it came back from its farthest point"),
}

COMMAND = {
    "kind": Word("", "stop, velocity or position; empty: nothing"),
    "position": Word("rad", "position to go to"),
    "velocity": Word("rad/s", "velocity to keep"),
    "speed": Word("rad/s", "top speed towards the position"),
}

PREDICTION = Word("rad", "expected position, at this timescale in steps (thesis 5.3)")
ERRORS = Word("", "JSON list of what the servo complains of")
JOINTS_OF_GROUP = Word("", "JSON list of the group's joints")
META = Word("", "JSON of the experimenter's note (set_meta)")
OTHER = Word("", "JSON of what was in the frame and has no column of its own; empty as a rule")
