"""Which arm a simulated bus carries: the joints of a config file, or the Bento Arm."""

import tomllib
from pathlib import Path
from typing import TypeAlias

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from bentod.contracts import ArmConfig
from bentod.errors import ConfigError
from bentod.frames import JointSpec, Value
from sim.bento import bento_joints
from sim.options import Options

PERIOD = 1 / 30
"""s"""

Flat: TypeAlias = bool | int | float | str
"""What stands in a servo's table."""


class _Joint(BaseModel):
    """What of a joint matters here; the rest of the file is for the daemon."""

    model_config = ConfigDict(frozen=True)

    name: str
    min_rad: float
    max_rad: float
    max_velocity_rad_s: float = 1.0
    home_rad: float = 0.0
    hardware: dict[str, Flat]

    def spec(self) -> JointSpec:
        """The joint as drivers see it."""
        hardware: dict[str, Value] = dict(self.hardware)
        return JointSpec(
            self.name, self.min_rad, self.max_rad, self.max_velocity_rad_s, self.home_rad, hardware
        )


class _File(BaseModel):
    """What of a config file matters here: joints that name a driver of their own are on another bus."""

    driver: dict[str, object] = Field(default_factory=dict)
    joints: tuple[_Joint, ...]

    @field_validator("joints", mode="before")
    @classmethod
    def _of_this_bus(cls, joints: object) -> object:
        if not isinstance(joints, list):
            return joints
        return [joint for joint in joints if not (isinstance(joint, dict) and joint.get("driver"))]


def load(path: Path | None, seed: int | None) -> ArmConfig:
    """The arm in the file at `path`, the Bento Arm without one; `seed` goes before the file's.

    Raises:
        ConfigError: the file cannot be read or does not describe joints.
    """
    if path is None:
        return ArmConfig(bento_joints(), PERIOD, {} if seed is None else {"seed": seed})
    joints, options = _read(path)
    return ArmConfig(joints, PERIOD, options if seed is None else {**options, "seed": seed})


def _read(path: Path) -> tuple[tuple[JointSpec, ...], dict[str, Value]]:
    """Joints, and what of the driver's table a simulated arm understands."""
    try:
        file = _File.model_validate(tomllib.loads(path.read_text(encoding="utf-8")))
        known = {key: value for key, value in file.driver.items() if key in Options.model_fields}
        options: dict[str, Value] = Options.model_validate(known).model_dump()
        return tuple(joint.spec() for joint in file.joints), options
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise ConfigError(f"{path}: {key}: {first['msg']}.", key) from None
