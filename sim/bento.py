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
from sim.dynamixel import tables
from sim.dynamixel.bus import FAST_RATES, Bus
from sim.dynamixel.device import Device
from sim.options import Options
from sim.servo import CENTRE, TICK, Link, Servo
from sim.servo_models import SERVO_MODELS

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
            minimum=(low - CENTRE) * TICK,
            maximum=(high - CENTRE) * TICK,
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
    return Arm([_servo(spec, parse_hardware(spec), options) for spec in config.joints], time)


def build_bus(arm: Arm, config: ArmConfig, options: Options, timing: bool = True) -> Bus:
    """Control tables in front of the servos, provisioned as the config wants them."""
    devices = [
        _device(servo, spec, parse_hardware(spec), options)
        for servo, spec in zip(arm.servos, config.joints, strict=True)
    ]
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
    provisioned = {
        tables.ID: hardware.id,
        tables.BAUD: _baud_register(options.baud),
        tables.RETURN_DELAY: 0,
        tables.CW_LIMIT: CENTRE + round(spec.minimum / TICK),
        tables.CCW_LIMIT: CENTRE + round(spec.maximum / TICK),
    }
    return Device(tables.TABLES[hardware.model], servo, provisioned)


def _baud_register(baud: int) -> int:
    for register, rate in FAST_RATES.items():
        if rate == baud:
            return register
    return min(max(round(2_000_000 / baud) - 1, 0), 249)
