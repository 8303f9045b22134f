"""Any entry that there can be, and the comparison of entries bit by bit."""

import dataclasses
import struct
from collections.abc import Mapping
from typing import cast

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis import strategies as st

from bentod.frames import (
    AssistFrame,
    ClientCommand,
    Command,
    Costs,
    EmgBlock,
    EmgFrame,
    Event,
    Frame,
    Freshness,
    GoalFrame,
    GroupFrame,
    JointFrame,
    Mode,
    Position,
    Stop,
    StopReport,
    Trial,
    Value,
    Velocity,
)
from bentod.record.session import Entry

SLOW_IS_FINE = settings(
    deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture]
)
"""For tests with many values; the machine may be busy."""

floats = st.floats(width=64)
texts = st.text(max_size=12)
integers = st.integers(-(2**63), 2**63 - 1)
values: st.SearchStrategy[Value] = st.recursive(
    st.none() | st.booleans() | st.integers() | floats | texts | st.binary(max_size=8),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)
tables = st.dictionaries(texts, values, max_size=3)
stops = st.builds(StopReport, texts, floats, floats, floats)
trials = st.builds(Trial, integers, texts, texts, floats)
commands: st.SearchStrategy[Command] = (
    st.just(Stop()) | st.builds(Velocity, floats) | st.builds(Position, floats, floats)
)
numbers = st.dictionaries(texts, floats, max_size=3)
words = st.lists(texts, max_size=3).map(tuple)

joints = st.builds(
    JointFrame,
    name=texts,
    mode=st.sampled_from(Mode),
    torque=st.booleans(),
    position=floats,
    velocity=floats,
    load=floats,
    voltage=floats,
    temperature=floats,
    age=floats,
    freshness=st.sampled_from(Freshness),
    errors=words,
    stop=st.none() | stops,
    asked=st.dictionaries(texts, commands, max_size=3),
    holder=texts,
    sent=st.none() | commands,
    limited=texts,
    predictions=numbers,
)

frames = st.builds(
    Frame,
    tick=integers,
    time=floats,
    wall=floats,
    lateness=floats,
    missed=integers,
    costs=st.builds(Costs, floats, floats, floats, floats),
    shed=integers,
    rate_hz=floats,
    mode=st.sampled_from(Mode),
    fault=texts,
    joints=st.lists(joints, max_size=3).map(tuple),
    emg=st.builds(
        EmgFrame, st.booleans(), st.booleans(), texts, integers, floats, integers, numbers, integers
    ),
    groups=st.lists(st.builds(GroupFrame, texts, words, texts, floats, texts, st.booleans()), max_size=2).map(
        tuple
    ),
    assist=st.builds(AssistFrame, texts, st.booleans(), texts, texts, texts, numbers, st.booleans()),
    goal=st.none() | st.builds(GoalFrame, integers, texts, st.just("moving"), floats, texts),
    meta=values,
    gap=st.booleans(),
    read_at=floats,
    trial=st.none() | trials,
    whole=st.booleans(),
)


@st.composite
def emg_blocks(draw: st.DrawFn) -> EmgBlock:
    """A block of any shape, each sample any 32 bits."""
    shape = (draw(st.integers(0, 5)), draw(st.integers(0, 4)))
    count = shape[0] * shape[1]
    data = draw(st.binary(min_size=4 * count, max_size=4 * count))
    samples = np.frombuffer(data, np.float32).reshape(shape)
    return EmgBlock(draw(integers), draw(floats), samples, draw(integers))


events = st.builds(Event, time=floats, kind=texts, text=texts, data=tables)
client_commands = st.builds(
    ClientCommand, time=floats, tick=integers, client=texts, method=texts, params=values, error=texts
)

entries: st.SearchStrategy[Entry] = frames | emg_blocks() | events | client_commands


def bits(value: object) -> object:
    """A value that is equal to another's only if both are the same, nan and the sign of zero included."""
    if isinstance(value, float):
        return "nan" if value != value else struct.pack("<d", value)
    if isinstance(value, np.ndarray):
        return (value.dtype.str, value.shape, value.tobytes())
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = [bits(getattr(value, field.name)) for field in dataclasses.fields(value)]
        return (type(value), *fields)
    if isinstance(value, Mapping):
        return {key: bits(item) for key, item in cast("Mapping[object, object]", value).items()}
    if isinstance(value, list | tuple):
        return (type(value), *[bits(item) for item in value])
    return (type(value), value)
