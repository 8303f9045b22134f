"""A recording as a ROS 2 bag (MCAP storage), with messages that every ROS knows. Needs rosbags."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from bentod.analysis.columns import as_json
from bentod.analysis.export import about, save_dictionary
from bentod.frames import ClientCommand, EmgBlock, Event, Frame
from bentod.record.reader import Recording

_STORE = get_typestore(Stores.ROS2_JAZZY)
_JOINT_STATE = _STORE.types["sensor_msgs/msg/JointState"]
_HEADER = _STORE.types["std_msgs/msg/Header"]
_TIME = _STORE.types["builtin_interfaces/msg/Time"]
_STRING = _STORE.types["std_msgs/msg/String"]
_MULTI_ARRAY = _STORE.types["std_msgs/msg/Float32MultiArray"]
_LAYOUT = _STORE.types["std_msgs/msg/MultiArrayLayout"]
_DIMENSION = _STORE.types["std_msgs/msg/MultiArrayDimension"]

TOPICS = {
    "/joint_states": "what was read: rad, rad/s, and as effort the share of the greatest torque, −1..1",
    "/bentod/predictions_<timescale>": "expected positions (rad), of a timescale in steps",
    "/bentod/frame": "JSON of the tick's whole frame",
    "/bentod/emg": "V; the first dimension's label tells the index of the first sample and what was lost",
    "/bentod/events": "JSON of events",
    "/bentod/commands": "JSON of what clients asked, and why it was refused",
}


@dataclass(slots=True)
class _Bag:
    """A bag under way; its times are wall time, by the relation that the recording holds."""

    writer: Writer
    shift: float  # s from monotonic to wall time
    connections: dict[str, Connection] = field(default_factory=dict)

    def put(self, topic: str, time: float, message: object, kind: str) -> None:
        if topic not in self.connections:
            self.connections[topic] = self.writer.add_connection(topic, kind, typestore=_STORE)
        self.writer.write(self.connections[topic], self.stamp(time), _STORE.serialize_cdr(message, kind))

    def stamp(self, time: float) -> int:
        """Nanoseconds since 1970 of a monotonic time (s)."""
        return round((time + self.shift) * 1e9)

    def frame(self, frame: Frame) -> None:
        joints = frame.joints
        names = [joint.name for joint in joints]
        read = [[j.position for j in joints], [j.velocity for j in joints], [j.load for j in joints]]
        self._joint_state("/joint_states", frame.read_at or frame.time, names, read)
        for timescale in joints[0].predictions if joints else ():
            known = [joint for joint in joints if timescale in joint.predictions]
            expected = [joint.predictions[timescale] for joint in known]
            topic = f"/bentod/predictions_{timescale.replace('.', '_')}"
            self._joint_state(topic, frame.time, [joint.name for joint in known], [expected, [], []])
        self.text("/bentod/frame", frame.time, frame)

    def _joint_state(
        self, topic: str, time: float, names: list[str], values: Sequence[Sequence[float]]
    ) -> None:
        seconds, nanoseconds = divmod(self.stamp(time), 1_000_000_000)
        header = _HEADER(stamp=_TIME(sec=seconds, nanosec=nanoseconds), frame_id="")
        position, velocity, effort = (np.array(column, dtype=np.float64) for column in values)
        message = _JOINT_STATE(header=header, name=names, position=position, velocity=velocity, effort=effort)
        self.put(topic, time, message, "sensor_msgs/msg/JointState")

    def emg(self, block: EmgBlock) -> None:
        samples, channels = block.samples.shape
        label = f"samples from {block.first_index}, after {block.dropped} lost"
        layout = _LAYOUT(
            dim=[
                _DIMENSION(label=label, size=samples, stride=samples * channels),
                _DIMENSION(label="channels", size=channels, stride=channels),
            ],
            data_offset=0,
        )
        message = _MULTI_ARRAY(layout=layout, data=np.ascontiguousarray(block.samples).reshape(-1))
        self.put("/bentod/emg", block.time, message, "std_msgs/msg/Float32MultiArray")

    def text(self, topic: str, time: float, entry: Frame | Event | ClientCommand) -> None:
        self.put(topic, time, _STRING(data=as_json(entry)), "std_msgs/msg/String")


def write_rosbag(recording: Recording, folder: Path, tables: Collection[str]) -> Mapping[str, int]:
    """A bag of the chosen tables, as messages; returns how many of each."""
    header = recording.header
    kinds = {"ticks": Frame, "emg": EmgBlock, "events": Event, "commands": ClientCommand}
    counts = dict.fromkeys(tables, 0)
    tables_of = {kinds[table]: table for table in tables}
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        bag = _Bag(writer, header.started_wall - header.started)
        for entry in recording.entries(kinds=tuple(tables_of)):
            counts[tables_of[type(entry)]] += 1
            _put(bag, entry)
    save_dictionary(folder, {**about(header), "topics": TOPICS})
    return counts


def _put(bag: _Bag, entry: Frame | EmgBlock | Event | ClientCommand) -> None:
    match entry:
        case Frame():
            bag.frame(entry)
        case EmgBlock():
            bag.emg(entry)
        case Event():
            bag.text("/bentod/events", entry.time, entry)
        case ClientCommand():
            bag.text("/bentod/commands", entry.time, entry)
