"""What a config file says should be on the bus, and what of it is not so."""

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value
from drivers.dynamixel.doctor.findings import Finding, degrees, limits
from drivers.dynamixel.doctor.vitals import Vitals
from drivers.dynamixel.options import Hardware, Options, parse_hardware


class _Joint(BaseModel):
    """What of a joint matters here; the rest of the file is for the daemon."""

    model_config = ConfigDict(frozen=True)

    name: str
    min_rad: float
    max_rad: float
    driver: str = ""
    hardware: dict[str, object] = Field(default_factory=dict)


class _File(BaseModel):
    """What of a config file matters here."""

    driver: dict[str, object] = Field(default_factory=dict)
    drivers: dict[str, dict[str, object]] = Field(default_factory=dict)
    joints: tuple[_Joint, ...]


@dataclass(frozen=True, slots=True)
class Wanted:
    """One joint that should be on the bus."""

    joint: str
    minimum: float  # rad
    maximum: float  # rad
    hardware: Hardware
    baud: int  # bit/s


def load(path: Path, port: str) -> list[Wanted]:
    """The Dynamixel joints of the config at `path`; with several Dynamixel drivers, those on `port`.

    Raises:
        ConfigError: it cannot be read, or a joint of such a driver is not described well.
    """
    try:
        file = _File.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{path}: {key}: {first['msg']}.", key) from None
    tables = {"": file.driver, **file.drivers}
    ours = {key: table for key, table in tables.items() if "dynamixel" in str(table.get("name", ""))}
    if len(ours) > 1:
        ours = {key: table for key, table in ours.items() if _same(str(table.get("port", "")), port)}
    return [_wanted(joint, ours[joint.driver]) for joint in file.joints if joint.driver in ours]


def compare(wanted: Sequence[Wanted], found: Sequence[Vitals]) -> list[Finding]:
    """What is missing, of another kind, too narrow, or on the bus and not in the config."""
    by_id = {servo.id: servo for servo in found}
    findings = [finding for one in wanted for finding in _differences(one, by_id.get(one.hardware.id))]
    ids = {one.hardware.id for one in wanted}
    findings += [
        Finding(f"{servo} is on the bus and in no joint of the config.", note=True)
        for servo in found
        if servo.id not in ids
    ]
    return findings


def _differences(wanted: Wanted, servo: Vitals | None) -> Iterator[Finding]:
    its = wanted.hardware
    if servo is None:
        yield Finding(
            f"Joint {wanted.joint} should be servo {its.id}, an {its.model}, which does not answer.",
            "Look at its power, its cable, its ID and its baud rate.",
        )
        return
    if servo.name != its.model:
        found = servo.name or f"a servo with the model number {servo.number}"
        yield Finding(
            f"Joint {wanted.joint} should be an {its.model}; {servo} is {found}.",
            "Mend the wiring, the IDs or the config.",
        )
        return
    if servo.baud != wanted.baud:
        yield Finding(
            f"{servo} ({wanted.joint}) talks at {servo.baud} bit/s; the config says {wanted.baud}.",
            f"`bentod servo set-baud {servo.id} {wanted.baud}`, or change the config.",
        )
    yield from _narrow(wanted, servo)


def _narrow(wanted: Wanted, servo: Vitals) -> Iterator[Finding]:
    its, model = limits(servo), servo.model
    if its is None or model is None:
        return
    room = model.tick / 2  # the nearest tick is good enough
    if its[0] > wanted.minimum + room or its[1] < wanted.maximum - room:
        yield Finding(
            f"{servo} ({wanted.joint}) may go {degrees(*its)}, and the config wants "
            f"{degrees(wanted.minimum, wanted.maximum)}.",
            f"Widen its {model.layout.lowest} and {model.layout.highest} with the servo maker's tool, "
            "or narrow the config.",
        )


def _wanted(joint: _Joint, driver: Mapping[str, object]) -> Wanted:
    hardware: dict[str, Value] = {
        key: value for key, value in joint.hardware.items() if isinstance(value, bool | int | float | str)
    }
    spec = JointSpec(joint.name, joint.min_rad, joint.max_rad, 1.0, 0.0, hardware)
    baud = driver.get("baud", Options.model_fields["baud"].default)
    if not isinstance(baud, int):
        raise ConfigError(f"baud is {baud!r}, not a number", field="baud")
    return Wanted(joint.name, joint.min_rad, joint.max_rad, parse_hardware(spec), baud)


def _same(one: str, other: str) -> bool:
    return Path(one).resolve() == Path(other).resolve()
