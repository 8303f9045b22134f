"""Values and headers as JSON, which people and every tool can read in a file."""

import json
from base64 import b64decode, b64encode
from collections.abc import Mapping
from typing import cast

from bentod.frames import Bounds, JointSpec, Value

_BYTES = "$bytes"


def to_json(value: Value) -> str:
    """A value as JSON, exactly. Bytes become `{"$bytes": base64}`; a key with a dollar in front gets another.

    Half a surrogate pair, which UTF-8 has no form for, is spelled as JSON's own escape.
    """
    text = json.dumps(_plain(value), ensure_ascii=False, separators=(",", ":"))
    return text.encode("utf-8", "backslashreplace").decode()


def from_json(text: str) -> Value:
    """What `to_json` was given; empty text is None."""
    return _rich(json.loads(text)) if text else None


def _plain(value: Value) -> Value:
    if isinstance(value, bytes):
        return {_BYTES: b64encode(value).decode()}
    if isinstance(value, Mapping):
        return {_key(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    return value


def _key(key: object) -> str:
    text = key if isinstance(key, str) else repr(key)  # a client may send what is no text
    return f"${text}" if text.startswith("$") else text


def _rich(value: Value) -> Value:
    if isinstance(value, dict):
        if list(value) == [_BYTES]:
            return b64decode(str(value[_BYTES]))
        return {key.removeprefix("$") if key.startswith("$$") else key: _rich(v) for key, v in value.items()}
    if isinstance(value, list):
        return [_rich(item) for item in value]
    return value


def joint_to_json(joint: JointSpec) -> str:
    """One joint of the robot's description."""
    bounds = {name: getattr(joint.bounds, name) for name in Bounds.__dataclass_fields__}
    return to_json(
        {
            "minimum": joint.minimum,
            "maximum": joint.maximum,
            "max_velocity": joint.max_velocity,
            "home": joint.home,
            "hardware": dict(joint.hardware),
            "bounds": cast("Value", bounds),
        }
    )


def joint_from_json(name: str, text: str) -> JointSpec:
    """The joint again; bounds that the file does not know have their defaults."""
    table = cast("dict[str, Value]", from_json(text))
    minimum, maximum, speed, home = (
        cast("float", table[key]) for key in ("minimum", "maximum", "max_velocity", "home")
    )
    known = cast("dict[str, float]", table.get("bounds") or {})
    bounds = Bounds(**{key: value for key, value in known.items() if key in Bounds.__dataclass_fields__})
    return JointSpec(name, minimum, maximum, speed, home, cast("dict[str, Value]", table["hardware"]), bounds)
