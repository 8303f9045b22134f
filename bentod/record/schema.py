"""The messages of a recording as data: every field with the number that it keeps for ever.

A new field takes the next free number, and old files read with its default. A number is never used again.
What a message means changes only together with `session.SCHEMA`.
"""

from bentod.frames import (
    AssistFrame,
    ClientCommand,
    Costs,
    EmgBlock,
    EmgFrame,
    Event,
    Frame,
    Freshness,
    GoalFrame,
    GroupFrame,
    JointFrame,
    LearnFrame,
    Mode,
    Position,
    Stop,
    StopReport,
    Trial,
    Velocity,
)
from bentod.joystick_frame import JoystickFrame
from bentod.recognition_frame import RecognitionFrame
from bentod.record.field import Field, Kind, Message
from bentod.record.session import SCHEMA, Counts, Gap, Mark, Report, Tally

PACKAGE = f"bentod.v{SCHEMA}"

ENUMS: dict[str, tuple[str, ...]] = {
    "Mode": (Mode.LIMP, Mode.HOLDING, Mode.ACTIVE, Mode.PAUSED, Mode.FAULT),
    "Freshness": (Freshness.FRESH, Freshness.STALE, Freshness.LOST),
    "CommandKind": ("stop", "velocity", "position"),
}
"""Values in the order of their numbers, from 1. New ones come last."""

UNKNOWN = {"Mode": Mode.LIMP, "Freshness": Freshness.LOST, "CommandKind": "stop"}
"""What a missing value is read as."""

D, I, B, T = Kind.DOUBLE, Kind.INT, Kind.BOOL, Kind.TEXT  # noqa: E741 -- columns of the tables below

TABLE = (
    Message(
        "Command",
        (Stop, Velocity, Position),
        (
            Field(1, "kind", Kind.ENUM, "CommandKind"),
            Field(2, "velocity", D),
            Field(3, "position", D),
            Field(4, "speed", D),
        ),
    ),
    Message(
        "StopReport",
        (StopReport,),
        (Field(1, "rule", T), Field(2, "time", D), Field(3, "travel", D), Field(4, "bounce", D)),
    ),
    Message(
        "JointFrame",
        (JointFrame,),
        (
            Field(1, "name", T),
            Field(2, "mode", Kind.ENUM, "Mode"),
            Field(3, "torque", B),
            Field(4, "position", D),
            Field(5, "velocity", D),
            Field(6, "load", D),
            Field(7, "voltage", D),
            Field(8, "temperature", D),
            Field(9, "age", D),
            Field(10, "freshness", Kind.ENUM, "Freshness"),
            Field(11, "errors", Kind.TEXTS),
            Field(12, "stop", Kind.MAYBE, "StopReport"),
            Field(13, "asked", Kind.NAMED, "Command"),
            Field(14, "holder", T),
            Field(15, "sent", Kind.MAYBE, "Command"),
            Field(16, "limited", T),
            Field(17, "predictions", Kind.NUMBERS),
        ),
    ),
    Message(
        "EmgFrame",
        (EmgFrame,),
        (
            Field(1, "alive", B),
            Field(2, "paused", B),
            Field(3, "problem", T),
            Field(4, "next_index", I),
            Field(5, "age", D),
            Field(6, "dropped", I),
            Field(7, "effort", Kind.NUMBERS),
            Field(8, "toggles", I),
            Field(9, "recognition", Kind.MAYBE, "RecognitionFrame"),
        ),
    ),
    Message(
        "RecognitionFrame",
        (RecognitionFrame,),
        (
            Field(1, "index", I),
            Field(2, "label", T),
            Field(3, "speed", D),
            Field(4, "probabilities", Kind.NUMBERS),
            Field(5, "likely", T),
            Field(6, "rejected", B),
            Field(7, "reason", T),
            Field(8, "model", T),
            Field(9, "prompted", T),
            Field(10, "weight", D),
            Field(11, "unaided", T),
        ),
    ),
    Message(
        "GroupFrame",
        (GroupFrame,),
        (
            Field(1, "name", T),
            Field(2, "joints", Kind.TEXTS),
            Field(3, "active", T),
            Field(4, "effort", D),
            Field(5, "operator", T),
            Field(6, "together", B),
        ),
    ),
    Message(
        "GoalFrame",
        (GoalFrame,),
        (
            Field(1, "id", I),
            Field(2, "kind", T),
            Field(3, "status", T),
            Field(4, "progress", D),
            Field(5, "reason", T),
        ),
    ),
    Message(
        "AssistFrame",
        (AssistFrame,),
        (
            Field(1, "mode", T),
            Field(2, "engaged", B),
            Field(3, "reason", T),
            Field(4, "attended", T),
            Field(5, "group", T),
            Field(6, "moving", Kind.NUMBERS),
            Field(7, "offers_together", B),
        ),
    ),
    Message(
        "Trial",
        (Trial,),
        (Field(1, "number", I), Field(2, "name", T), Field(3, "condition", T), Field(4, "started", D)),
    ),
    Message(
        "Costs",
        (Costs,),
        (Field(1, "read", D), Field(2, "think", D), Field(3, "write", D), Field(4, "publish", D)),
    ),
    Message(
        "LearnFrame",
        (LearnFrame,),
        (
            Field(1, "predictions", Kind.NUMBERS),
            Field(2, "older", Kind.NUMBERS),
            Field(3, "confidence", Kind.NUMBERS),
            Field(4, "surprise", Kind.NUMBERS),
            Field(5, "error", Kind.NUMBERS),
            Field(6, "familiarity", Kind.NUMBERS),
        ),
    ),
    Message(
        "JoystickFrame",
        (JoystickFrame,),
        (
            Field(1, "connected", B),
            Field(2, "paused", B),
            Field(3, "problem", T),
            Field(4, "held", B),
            Field(5, "axes", Kind.NUMBERS),
        ),
    ),
    Message(
        "Frame",
        (Frame,),
        (
            Field(1, "tick", I),
            Field(2, "time", D),
            Field(3, "wall", D),
            Field(4, "lateness", D),
            Field(5, "missed", I),
            Field(6, "costs", Kind.ONE, "Costs"),
            Field(7, "shed", I),
            Field(8, "rate_hz", D),
            Field(9, "mode", Kind.ENUM, "Mode"),
            Field(10, "fault", T),
            Field(11, "joints", Kind.MANY, "JointFrame"),
            Field(12, "emg", Kind.ONE, "EmgFrame"),
            Field(13, "groups", Kind.MANY, "GroupFrame"),
            Field(14, "assist", Kind.ONE, "AssistFrame"),
            Field(15, "goal", Kind.MAYBE, "GoalFrame"),
            Field(16, "meta", Kind.JSON),
            Field(17, "gap", B),
            Field(18, "read_at", D),
            Field(19, "trial", Kind.MAYBE, "Trial"),
            Field(20, "whole", B),
            Field(21, "learn", Kind.ONE, "LearnFrame"),
            Field(22, "more_assists", Kind.MANY, "AssistFrame"),
            Field(23, "joystick", Kind.MAYBE, "JoystickFrame"),
        ),
    ),
    Message(
        "EmgBlock",
        (EmgBlock,),
        (
            Field(1, "first_index", I),
            Field(2, "time", D),
            Field(3, "dropped", I),
            Field(4, "length", I),  # samples in the block
            Field(5, "channels", I),
            Field(6, "samples", Kind.FLOATS),  # V: all channels of the first sample, then of the second …
        ),
    ),
    Message(
        "Event",
        (Event,),
        (Field(1, "time", D), Field(2, "kind", T), Field(3, "text", T), Field(4, "data", Kind.JSON)),
    ),
    Message(
        "ClientCommand",
        (ClientCommand,),
        (
            Field(1, "time", D),
            Field(2, "tick", I),
            Field(3, "client", T),
            Field(4, "method", T),
            Field(5, "params", Kind.JSON),
            Field(6, "error", T),
        ),
    ),
    Message(
        "Mark",
        (Mark,),
        (
            Field(1, "time", D),
            Field(2, "tick", I),
            Field(3, "trial", Kind.MAYBE, "Trial"),
            Field(4, "meta", Kind.JSON),
        ),
    ),
    Message(
        "Counts",
        (Counts,),
        (Field(1, "frames", I), Field(2, "emg", I), Field(3, "events", I), Field(4, "commands", I)),
    ),
    Message("Gap", (Gap,), (Field(1, "start", D), Field(2, "end", D), Field(3, "missing", I))),
    Message(
        "Tally",
        (Tally,),
        (
            Field(1, "written", Kind.ONE, "Counts"),
            Field(2, "dropped", Kind.ONE, "Counts"),
            Field(3, "start", D),
            Field(4, "end", D),
            Field(5, "first_tick", I),
            Field(6, "last_tick", I),
            Field(7, "first_frame", D),
            Field(8, "last_frame", D),
            Field(9, "first_missed", I),
            Field(10, "last_missed", I),
            Field(11, "first_index", I),
            Field(12, "next_index", I),
            Field(13, "first_sample", D),
            Field(14, "last_sample", D),
            Field(15, "samples", I),
            Field(16, "tick_gaps", Kind.MANY, "Gap"),
            Field(17, "emg_gaps", Kind.MANY, "Gap"),
            Field(18, "ticks_missing", I),
            Field(19, "samples_missing", I),
        ),
    ),
    Message(
        "Report",
        (Report,),
        (
            Field(1, "time", D),
            Field(2, "text", T),
            Field(3, "closing", B),
            Field(4, "tally", Kind.ONE, "Tally"),
        ),
    ),
)

MESSAGES = {message.name: message for message in TABLE}
