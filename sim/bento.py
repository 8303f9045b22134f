"""The simulated Bento Arm: which servo carries what, and how a config becomes an arm and its bus.

Geometry, joint limits and speeds from the Bento Arm, brachIOplexus and Virtual-Bento by the BLINC Lab,
University of Alberta. Masses are estimates, and so are the torques and inertias that follow from them.
"""

from dataclasses import dataclass
from math import pi, radians

from bentod.contracts import ArmConfig
from bentod.frames import JointSpec
from drivers.dynamixel.options import Hardware, parse_hardware
from sim.arm import Arm
from sim.dynamixel.bus import Bus
from sim.dynamixel.device import Device
from sim.dynamixel.faults import RegisterFaults
from sim.dynamixel.models import TABLES, build_device
from sim.options import Options
from sim.servo import Servo
from sim.servo_models import MX_SCALE, SERVO_MODELS
from sim.shaft import Link, Stand

STOP_MARGIN = 0.02
"""rad from a joint's limit to its hard stop, assumed."""

DOWN = -pi / 2
"""rad at which a flexion joint hangs: at 0 the forearm is level, and flexion lifts it (sense unverified)."""


@dataclass(frozen=True, slots=True)
class Burden:
    """What a joint of the Bento Arm carries in the zero pose."""

    gravity: float  # N m
    inertia: float  # kg m²


BURDENS = {
    "shoulder_rotation": Burden(0.0, 0.017),
    "elbow_flexion": Burden(0.67, 0.013),
    "wrist_rotation": Burden(0.0, 0.0003),
    "wrist_flexion": Burden(0.12, 0.001),
    "gripper": Burden(0.0, 0.0001),
}

NOTHING = Burden(0.0, 0.0)


def bento_joints() -> tuple[JointSpec, ...]:
    """The Bento Arm as brachIOplexus ships it: limits in ticks, greatest speed in units of 0.684 °/s."""
    rows = (
        ("shoulder_rotation", "MX-64", 1028, 3073, 67),
        ("elbow_flexion", "MX-106", 1784, 2570, 45),
        ("wrist_rotation", "MX-28", 1028, 3073, 90),
        ("wrist_flexion", "MX-28", 790, 3328, 67),
        ("gripper", "MX-28", 1928, 2800, 90),
    )
    return tuple(
        JointSpec(
            name=name,
            minimum=MX_SCALE.angle(low),
            maximum=MX_SCALE.angle(high),
            max_velocity=radians(0.684 * speed),
            home=0.0,
            hardware={"id": i, "model": model},
        )
        for i, (name, model, low, high, speed) in enumerate(rows, 1)
    )


def build_arm(config: ArmConfig, options: Options, time: float) -> Arm:
    """The arm of `config` at rest and limp, `time` being now (monotonic s).

    Raises:
        ConfigError: a joint's hardware is not described well.
    """
    arm = Arm([_servo(spec, parse_hardware(spec), options) for spec in config.joints], time)
    stand = Stand(options.stand)
    for servo in arm.servos:
        servo.stand = stand
    return arm


def build_bus(arm: Arm, config: ArmConfig, options: Options, timing: bool = True) -> Bus:
    """Control tables in front of the servos, provisioned as the config wants them; adds faults to the arm."""
    devices = [
        _device(servo, spec, parse_hardware(spec), options)
        for servo, spec in zip(arm.servos, config.joints, strict=True)
    ]
    arm.offer(RegisterFaults(devices).faults())
    return Bus(devices, options.baud, timing)


def _servo(spec: JointSpec, hardware: Hardware, options: Options) -> Servo:
    burden = BURDENS.get(spec.name, NOTHING)
    start = options.start_rad.get(spec.name, spec.home)
    link = Link(
        gravity=options.gravity_nm.get(spec.name, burden.gravity),
        rest=DOWN,
        inertia=burden.inertia,
        low=min(spec.minimum - STOP_MARGIN, start),
        high=max(spec.maximum + STOP_MARGIN, start),
    )
    model = SERVO_MODELS[hardware.model]
    servo = Servo(model, link, start, options.servo_dead_time_s, f"{options.seed}/{spec.name}")
    servo.room = servo.ambient = servo.temperature = options.temperature
    return servo


def _device(servo: Servo, spec: JointSpec, hardware: Hardware, options: Options) -> Device:
    table = TABLES[hardware.model]
    lowest, highest = options.limits_rad.get(spec.name, (spec.minimum, spec.maximum))
    provisioned = {
        table.common.id: hardware.id,
        table.common.baud: table.baud_register(options.baud),
        table.common.return_delay: 0,
        table.common.lowest: _ticks(servo, lowest),
        table.common.highest: _ticks(servo, highest),
    }
    return build_device(servo, provisioned)


def _ticks(servo: Servo, position: float) -> int:
    scale = servo.model.scale
    return min(max(scale.ticks(position), 0), scale.last)
