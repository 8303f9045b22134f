"""What is read back is what was put, bit by bit, and the schema knows every field there is."""

import dataclasses
import re

import pytest
from google.protobuf.descriptor_pb2 import FileDescriptorSet
from google.protobuf.descriptor_pool import DescriptorPool
from google.protobuf.message import Message as Decoded
from google.protobuf.message_factory import GetMessageClass
from hypothesis import given
from hypothesis import strategies as st

from bentod.frames import AssistFrame, Frame, Freshness, JointSpec, Mode, Value
from bentod.record.codec import ENCODERS, SCHEMAS, TOPICS, Plots, encode_log
from bentod.record.decode import decode
from bentod.record.descriptors import descriptor_set, field_names
from bentod.record.field import Message
from bentod.record.plain import from_json, joint_from_json, joint_to_json, to_json
from bentod.record.schema import ENUMS, TABLE
from bentod.record.session import Entry
from tests.record import strategies
from tests.record.strategies import SLOW_IS_FINE, bits

pairs = st.lists(strategies.joints, min_size=2, max_size=3).map(tuple)
JOINTS = tuple(JointSpec(name, -1.0, 1.0, 0.5, 0.0, {}) for name in ("shoulder", "elbow"))


def pool(joints: tuple[JointSpec, ...] = JOINTS) -> DescriptorPool:
    """What a tool makes of the descriptors in a file."""
    made = DescriptorPool()
    for file in FileDescriptorSet.FromString(descriptor_set(joints)).file:
        made.Add(file)
    return made


def parsed(topic: str, data: bytes) -> Decoded:
    """A message as a tool reads it: with nothing but the descriptors in the file."""
    return GetMessageClass(pool().FindMessageTypeByName(SCHEMAS[topic])).FromString(data)


@SLOW_IS_FINE
@given(strategies.entries)
def test_every_entry_is_read_back_bit_by_bit(entry: Entry) -> None:
    assert bits(decode(type(entry), ENCODERS[type(entry)](entry))) == bits(entry)


@SLOW_IS_FINE
@given(strategies.values)
def test_every_value_survives_as_json(value: Value) -> None:
    assert bits(from_json(to_json(value))) == bits(value)


@pytest.mark.parametrize("value", ["\ud800", {"\udfff": "a"}, {"$bytes": "x"}, {"$$": 1}, {"$bytes": b"x"}])
def test_values_that_look_like_something_else_survive_as_json(value: Value) -> None:
    assert from_json(to_json(value)) == value


@pytest.mark.parametrize("message", TABLE, ids=lambda message: message.name)
def test_every_field_of_every_class_is_in_the_schema(message: Message) -> None:
    attributes = {field.name for cls in message.classes for field in dataclasses.fields(cls)}
    written = {field.name for field in message.fields}
    assert attributes <= written, "give the new field the next free number in bentod/record/schema.py"


@pytest.mark.parametrize("message", TABLE, ids=lambda message: message.name)
def test_no_number_stands_twice(message: Message) -> None:
    numbers = [field.number for field in message.fields]
    assert len(set(numbers)) == len(numbers)


def test_every_class_inside_a_frame_has_a_message() -> None:
    named = {cls.__name__ for message in TABLE for cls in message.classes}
    inside = set(re.findall(r"\b[A-Z]\w*(?:Frame|Report|Costs|Trial)\b|\bTrial\b|\bCosts\b", annotations()))
    assert inside <= named | set(ENUMS)


def test_every_value_of_an_enum_has_a_number() -> None:
    assert set(ENUMS["Mode"]) == set(Mode)
    assert set(ENUMS["Freshness"]) == set(Freshness)
    assert ENUMS["Mode"][:5] == ("limp", "holding", "active", "paused", "fault")  # these are in files


def annotations() -> str:
    """The types of all fields of all classes in the table."""
    return " ".join(str(f.type) for m in TABLE for cls in m.classes for f in dataclasses.fields(cls))


NUMBERS = {
    "Frame": "tick1 time2 wall3 lateness4 missed5 costs6 shed7 rate_hz8 mode9 fault10 joints11 emg12 "
    "groups13 assist14 goal15 meta16 gap17 read_at18 trial19 whole20",
    "EmgBlock": "first_index1 time2 dropped3 length4 channels5 samples6",
    "Event": "time1 kind2 text3 data4",
    "ClientCommand": "time1 tick2 client3 method4 params5 error6",
    "JointFrame": "name1 mode2 torque3 position4 velocity5 load6 voltage7 temperature8 age9 freshness10 "
    "errors11 stop12 asked13 holder14 sent15 limited16 predictions17",
}


@pytest.mark.parametrize("name", NUMBERS)
def test_numbers_that_are_in_files_stay_what_they_are(name: str) -> None:
    fields = next(message for message in TABLE if message.name == name).fields
    found = " ".join(f"{field.name}{field.number}" for field in fields)
    assert found.startswith(NUMBERS[name])


def test_a_frame_of_an_older_file_has_the_defaults_of_what_is_new() -> None:
    frame = decode(Frame, b"\x09\x05\x00\x00\x00\x00\x00\x00\x00")
    assert isinstance(frame, Frame)
    assert (frame.tick, frame.trial, frame.whole, frame.joints) == (5, None, True, ())
    assert frame.assist == AssistFrame("", False, "")


@SLOW_IS_FINE
@given(strategies.entries)
def test_a_tool_reads_every_entry_with_the_descriptors_in_the_file(entry: Entry) -> None:
    topic = next(topic for topic, cls in TOPICS.items() if cls is type(entry))
    message = parsed(topic, ENCODERS[type(entry)](entry))
    assert bits(getattr(message, "time")) == bits(entry.time)  # noqa: B009 -- protobuf's class is made at run time


@SLOW_IS_FINE
@given(st.builds(dataclasses.replace, strategies.frames, joints=pairs))
def test_plots_have_a_field_for_each_joint_by_its_name(frame: Frame) -> None:
    message = parsed("/joints", Plots(JOINTS).encode(frame))
    elbow = getattr(message, "elbow")  # noqa: B009
    found = (elbow.position, elbow.velocity, elbow.load)
    joint = frame.joints[1]
    assert bits(found) == bits((joint.position, joint.velocity, joint.load))


def test_joints_with_odd_names_can_be_plotted_too() -> None:
    odd = [JointSpec(name, -1.0, 1.0, 0.5, 0.0, {}) for name in ("a b", "a_b", "1", "é")]
    assert len(set(field_names(odd))) == 4
    assert len(pool(tuple(odd)).FindMessageTypeByName(SCHEMAS["/joints"]).fields) == 4


def test_an_event_is_a_line_in_the_log_of_viewers() -> None:
    message = parsed("/log", encode_log("fault", "joint 'elbow' is lost", 1_500_000_000_250_000_000))
    stamp = getattr(message, "timestamp")  # noqa: B009
    assert (stamp.seconds, stamp.nanos) == (1_500_000_000, 250_000_000)
    assert str(message).count("ERROR") == 1
    assert getattr(message, "message") == "joint 'elbow' is lost"  # noqa: B009


@SLOW_IS_FINE
@given(st.builds(JointSpec, st.just("elbow"), *[strategies.floats] * 4, strategies.tables))
def test_the_robot_is_described_exactly(joint: JointSpec) -> None:
    assert bits(joint_from_json("elbow", joint_to_json(joint))) == bits(joint)


def test_an_entry_that_does_not_fit_the_schema_is_refused() -> None:
    with pytest.raises(AttributeError):
        ENCODERS[Frame](object())
