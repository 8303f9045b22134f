"""How to speak of an arm, as its daemon tells: `[voice]` of its config, and the names of its joints."""

import logging

from pydantic import ValidationError

from bentod.config_voice import Voice
from bentod.frames import Value

_log = logging.getLogger(__name__)


def table_of(info: Value) -> Voice:
    """The table in the answer of `get_info`; the usual one where it is missing or not understood."""
    told = info.get("voice") if isinstance(info, dict) else None
    given = told if isinstance(told, dict) else {}
    known = {key: value for key, value in given.items() if key in Voice.model_fields}
    try:
        return Voice.model_validate(known)
    except ValidationError as error:
        _log.warning("the daemon's [voice] is not understood, and left aside: %s", error.errors()[0]["msg"])
        return Voice()


def joints_of(info: Value) -> tuple[str, ...]:
    """Names of the joints, in the order of the arm."""
    joints = info.get("joints") if isinstance(info, dict) else None
    tables = joints if isinstance(joints, list) else []
    return tuple(str(joint.get("name")) for joint in tables if isinstance(joint, dict))
