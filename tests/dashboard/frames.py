"""Frames as `get_state` tells them, with only what a panel looks at, to be changed at will."""

import json
from collections.abc import Mapping
from typing import Any

NAMES = ("shoulder_rotation", "elbow_flexion", "wrist_rotation", "wrist_flexion", "gripper")

Table = dict[str, Any]


def frame(joints: Mapping[str, Table] | None = None, **changes: object) -> Table:
    """An active arm at rest, all angles 0, nobody moving it. `joints`: what differs, by name."""
    told: Table = {
        "rate_hz": 30.0,
        "mode": "active",
        "fault": "",
        "joints": [{**joint(name), **(joints or {}).get(name, {})} for name in NAMES],
        "emg": {"problem": "", "paused": False},
        "groups": [
            {"name": "arm", "joints": list(NAMES[:2]), "active": NAMES[0], "operator": "", "together": False}
        ],
        "assist": {"mode": "off", "engaged": False, "reason": "Assistance is switched off.", "attended": ""},
        "more_assists": [],
        "goal": None,
        "learn": {"confidence": {}, "error": {}, "familiarity": {}},
    }
    return {**told, **changes}


def joint(name: str) -> Table:
    """A joint at rest at 0 that is expected nowhere."""
    return {
        "name": name,
        "mode": "active",
        "torque": True,
        "position": 0.0,
        "velocity": 0.0,
        "load": 0.0,
        "temperature": 25.0,
        "age": 0.0,
        "freshness": "fresh",
        "errors": [],
        "holder": "",
        "limited": "",
        "predictions": {},
    }


def script(value: object) -> str:
    """The value as JavaScript."""
    return json.dumps(value)
