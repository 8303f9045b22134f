"""One snapshot out of several: what many arms have learned of the same questions (thesis 4.6.1).

Of every feature i the weights are averaged by how often each arm a was where that feature is active,

    w_i = Σ_a ω_a N_ai w_ai / Σ_a ω_a N_ai,

N being the counts of visits and ω a weight that somebody gives the arm. So an arm that has never been
somewhere has no say about it. This is the weighted average of federated learning (McMahan et al., AISTATS
2017), by feature instead of by arm.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Vector
from bentod.errors import SnapshotError
from bentod.frames import Value
from bentod.learn.differences import Sides, by_name, differences
from bentod.learn.snapshot import Snapshot

Numbers = NDArray[np.float64]
Memory = Mapping[str, Numbers]


def merge(snapshots: Sequence[Snapshot], weights: Sequence[float], names: Sequence[str]) -> Snapshot:
    """What all `snapshots` know together; `weights`: ω of each, `names`: what sentences call each.

    Visits are added up. Errors and confidence are those of the arm that has seen most, for a mean of them
    would be nobody's. Learning goes on from it as after a restart, without traces.

    Raises:
        SnapshotError: they answer other questions, or learned from other representations; the sentence says
            which; or a weight is not above 0.
    """
    if len(snapshots) < 2 or len(weights) != len(snapshots):
        raise SnapshotError(
            f"{len(snapshots)} snapshots with {len(weights)} weights: at least 2, a weight each"
        )
    if wrong := [weight for weight in weights if not 0 < weight < np.inf]:
        raise SnapshotError(f"a weight must be above 0 and finite, not {wrong[0]:g}")
    memories = [
        {name: array.astype(np.float64) for name, array in snapshot.arrays.items()} for snapshot in snapshots
    ]
    for place in range(1, len(snapshots)):
        _must_agree(snapshots, memories, names, place)
    merged = _merged(snapshots[0].spec, memories, np.array(weights, dtype=np.float64))
    return Snapshot(_header(snapshots, weights), merged)


def _must_agree(
    snapshots: Sequence[Snapshot], memories: Sequence[Memory], names: Sequence[str], place: int
) -> None:
    """Raises SnapshotError: the first and another one cannot be merged."""
    sides = Sides(f"in {names[0]}", f"in {names[place]}")
    if unlike := differences(snapshots[0].spec, snapshots[place].spec, sides):
        raise SnapshotError(f"{names[0]} and {names[place]} cannot be merged: {'; '.join(unlike)}")
    mine, theirs = (
        {k: array.shape for k, array in memory.items() if not k.endswith("/features") and k[:8] != "assists/"}
        for memory in (memories[0], memories[place])
    )
    if mine != theirs:
        key = min(key for key in mine.keys() | theirs.keys() if mine.get(key) != theirs.get(key))
        raise SnapshotError(
            f"{names[0]} and {names[place]} cannot be merged: their arrays '{key}' have other shapes"
        )


def _merged(spec: Mapping[str, Value], memories: Sequence[Memory], weights: Vector) -> dict[str, Numbers]:
    elder = memories[int(np.argmax([_experience(memory) for memory in memories]))]
    merged = {key: array.copy() for key, array in elder.items()}
    for name in by_name(spec.get("representations")) or {}:
        merged |= _visits(f"representations/{name}/visits", memories)
    for place, name in enumerate(_representations(spec)):
        unit = f"units/{place}/pupils"
        merged |= _pupils(unit, memories, _says(f"representations/{name}/visits", memories, weights))
        if f"{unit}/features" in merged:
            merged |= _at_rest(unit, merged)
    return merged


def _experience(memory: Memory) -> float:
    """Ticks, of the representation that has seen most."""
    return max(
        (float(array[0]) for key, array in memory.items() if key.endswith("/visits/ticks")), default=0.0
    )


def _representations(spec: Mapping[str, Value]) -> list[str]:
    """What each unit learns from."""
    questions = by_name(spec.get("questions")) or {}
    units = spec.get("units")
    first = [str(names[0]) for names in (units if isinstance(units, list) else []) if isinstance(names, list)]
    tables = [questions.get(name) for name in first]
    return [str(table.get("representation", "")) if isinstance(table, dict) else "" for table in tables]


def _says(visits: str, memories: Sequence[Memory], weights: Vector) -> Numbers | Vector:
    """How much each arm has to say about each feature, adding up to 1: shape (arms, features) or (arms,).

    About a feature that nobody has seen, and where features have no visits, as much as its ω.
    """
    if f"{visits}/counts" not in memories[0]:
        alike: Vector = weights / weights.sum()
        return alike
    counts = np.stack([memory[f"{visits}/counts"] for memory in memories])
    voice = weights[:, np.newaxis] * np.where(counts.any(axis=0), counts, 1.0)
    says: Numbers = voice / voice.sum(axis=0)
    return says


def _pupils(unit: str, memories: Sequence[Memory], says: Numbers | Vector) -> dict[str, Numbers]:
    """Averages of all that learners have for each feature, weights above all."""
    features = memories[0][f"{unit}/weights"].shape[0]
    keys = [key for key, array in memories[0].items() if key.startswith(f"{unit}/") and array.ndim]
    found: dict[str, Numbers] = {}
    for key in keys:
        stacked = [memory[key] for memory in memories]
        if key.endswith("/features") or stacked[0].shape[0] != features:
            continue
        voice = says.reshape(says.shape + (1,) * (1 + stacked[0].ndim - says.ndim))
        found[key] = sum((part * array for part, array in zip(voice, stacked, strict=True)), np.zeros(1))
    return found


def _at_rest(unit: str, merged: Memory) -> dict[str, Numbers]:
    """A group that has not set off: nothing is owed to weights that are not what they were."""
    taught, top, _ = merged[f"{unit}/reach"].tolist()
    return {
        f"{unit}/features": np.empty(0),
        f"{unit}/trace": np.zeros_like(merged[f"{unit}/trace"]),
        f"{unit}/v_old": merged[f"{unit}/v"].copy(),
        f"{unit}/reach": np.array([taught, top, 0.0]),
    }


def _visits(visits: str, memories: Sequence[Memory]) -> dict[str, Numbers]:
    """Counts of all together. A feature was last seen as long ago as by whom it was seen last."""
    if f"{visits}/counts" not in memories[0]:
        return {}
    counts, ticks = (sum(memory[f"{visits}/{key}"] for memory in memories) for key in ("counts", "ticks"))
    ago = np.min([memory[f"{visits}/ticks"] - memory[f"{visits}/last"] for memory in memories], axis=0)
    return {
        f"{visits}/counts": np.asarray(counts),
        f"{visits}/ticks": np.asarray(ticks),
        f"{visits}/last": np.asarray(ticks) - ago,
    }


def _header(snapshots: Sequence[Snapshot], weights: Sequence[float]) -> dict[str, Value]:
    parts: list[Value] = [
        {"arm": it.header.get("arm"), "tick": it.header.get("tick"), "digest": it.digest, "weight": weight}
        for it, weight in zip(snapshots, weights, strict=True)
    ]
    newest = max(snapshots, key=lambda it: _wall(it.header.get("wall")))
    return {**newest.header, "merged": parts, "spec": dict(snapshots[0].spec)}


def _wall(told: Value) -> float:
    return float(told) if isinstance(told, int | float) else 0.0
