"""The features of chapter 3 with the parameters of Table 3.2, one by one and together."""

from collections.abc import Mapping, Sequence

from bentod.frames import Value

Spec = Mapping[str, Value]
Specs = Sequence[Spec]

THRESHOLD_V = 0.1
"""At the converter (Table 3.2)."""

FLOOR_V = 0.05
"""At the converter: about what skin and amplifier give at rest."""

BIAS: Spec = {"name": "bias"}
"""Part of every feature vector (thesis 3.3.1)."""

SINGLE: Mapping[str, Spec] = {
    "MAV": {"name": "mav", "segments": 10},
    "ZC": {"name": "zc_product", "threshold_v": THRESHOLD_V},
    "SSC": {"name": "ssc", "threshold_v": THRESHOLD_V},
    "WL": {"name": "wl", "segments": 5},
    "VAR": {"name": "var_zero_mean", "segments": 6},
    "MAVS": {"name": "mavs", "segments": 5},
    "HIST": {"name": "hist", "bins": 70},
    "Ratios": {"name": "ratios", "segments": 5, "floor_v": FLOOR_V},
    "CC": {"name": "cc", "order": 2},
    "AR": {"name": "ar_burg", "order": 2},
}


def _together(*names: str) -> Specs:
    return (*(SINGLE[name] for name in names), BIAS)


TD, TD_AR, ALL = "TD", "TD/AR", "all"

TOGETHER: Mapping[str, Specs] = {
    TD: _together("MAV", "MAVS", "ZC", "SSC", "WL"),
    TD_AR: _together("MAV", "MAVS", "ZC", "SSC", "WL", "AR"),
    ALL: _together(*SINGLE),
}

SETS: Mapping[str, Specs] = {**TOGETHER, **{name: _together(name) for name in SINGLE}}
"""All that chapter 3 compares."""

ROBUST: Specs = ({"name": "robust", "floor_v": FLOOR_V},)
"""Our answer, which stands in `bentod.emg.features` for anybody to choose."""

USUAL: Specs = ({"name": "tdar", "threshold_v": THRESHOLD_V},)
"""TD/AR as most papers have it: no segments, no MAVS, four coefficients."""
