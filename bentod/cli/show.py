"""What the daemon answers, as a person or a program wants to read it."""

import json
import math
from collections.abc import Iterator

from bentod.frames import Value


def as_json(value: Value) -> str:
    """One line of JSON; a number that is not finite becomes null, bytes become hexadecimal."""
    return json.dumps(_finite(value), ensure_ascii=False)


def _finite(value: Value) -> Value:
    if isinstance(value, dict):
        return {key: _finite(entry) for key, entry in value.items()}
    if isinstance(value, list):
        return [_finite(entry) for entry in value]
    if isinstance(value, bytes):
        return value.hex()
    return None if isinstance(value, float) and not math.isfinite(value) else value


def as_text(value: Value) -> str:
    """Indented lines: `key: value`, and `- entry` for lists of more than plain values."""
    return "\n".join(_lines(value))


def _lines(value: Value, indent: str = "") -> Iterator[str]:
    if isinstance(value, dict):
        for key, entry in value.items():
            yield from _entry(f"{indent}{key}:", entry, indent)
    elif isinstance(value, list) and not _is_plain(value):
        for entry in value:
            yield from _entry(f"{indent}-", entry, indent)
    else:
        yield indent + word(value)


def _entry(head: str, entry: Value, indent: str) -> Iterator[str]:
    if _is_plain(entry):
        yield f"{head} {word(entry)}".rstrip()
    else:
        yield head
        yield from _lines(entry, indent + "  ")


def gvfs_text(value: Value) -> str:
    """A line for each general value function: what it says, how sure and how wrong it is."""
    columns = ("prediction", "confidence", "surprise", "error", "normalised_error")
    rows = [["GVF", "predicts", "confidence", "surprise", "error", "share of sd"]]
    for gvf in entries(value):
        if isinstance(gvf, dict):
            rows.append([word(gvf["name"]), *(_short(gvf.get(key)) for key in columns)])
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ([row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])] for row in rows)
    return "\n".join("  ".join(line) for line in lines)


def _short(value: Value) -> str:
    return f"{value:.4g}" if isinstance(value, int | float) else "-"


def _is_plain(value: Value) -> bool:
    if isinstance(value, list):
        return not any(isinstance(entry, dict | list) for entry in value)
    return not isinstance(value, dict) or not value


def word(value: Value) -> str:
    """A value within a line."""
    match value:
        case None:
            return "-"
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.4g}"
        case bytes():
            return value.hex()
        case list():
            return ", ".join(word(entry) for entry in value)
    return str(value)


def state_text(frame: Value) -> str:
    """A frame as a table of joints (angles in degrees) under a line about the arm, and what helps."""
    state = fields(frame)
    joints = [_joint_line(fields(joint)) for joint in entries(state.get("joints"))]
    assists = [fields(state.get("assist")), *map(fields, entries(state.get("more_assists")))]
    return "\n".join([_headline(state), *joints, *(_assist_line(assist) for assist in assists if assist)])


def _assist_line(assist: dict[str, Value]) -> str:
    moving = fields(assist.get("moving"))
    moves = ", ".join(f"{name} {_degrees(velocity)}°/s" for name, velocity in moving.items())
    name = " ".join(word(assist[key]) for key in ("mode", "group") if assist.get(key))
    offers = "   (all together may be selected)" if assist.get("offers_together") else ""
    return f"  assist {name}: {word(assist.get('reason'))}" + (f"   {moves}" if moves else "") + offers


def _headline(state: dict[str, Value]) -> str:
    parts = [f"tick {word(state.get('tick'))}", word(state.get("mode")).upper()]
    parts += [f"fault: {word(fault)}" for fault in [state.get("fault")] if fault]
    parts += [
        f"{word(group.get('name'))}: {'all together' if group.get('together') else word(group.get('active'))}"
        for group in map(fields, entries(state.get("groups")))
    ]
    goal = fields(state.get("goal"))
    parts += [f"{word(goal.get('kind'))} {word(goal.get('status'))}"] if goal else []
    return "   ".join(parts)


def _joint_line(joint: dict[str, Value]) -> str:
    return (
        f"  {word(joint.get('name')):<18}{word(joint.get('mode')):<9}"
        f"{_degrees(joint.get('position')):>8}°{_degrees(joint.get('velocity')):>8}°/s"
        f"  {word(joint.get('freshness')):<6} {word(joint.get('holder') or '')}"
    ).rstrip()


def _degrees(radians: Value) -> str:
    return f"{math.degrees(radians):.1f}" if isinstance(radians, int | float) else "-"


def event_text(event: Value) -> str:
    """An event as one line."""
    entry = fields(event)
    time = entry.get("time")
    stamp = f"{time:.3f}" if isinstance(time, int | float) else "-"
    return f"{stamp}  {word(entry.get('kind'))}: {word(entry.get('text'))}"


def method_text(entry: Value) -> str:
    """A method of the table as one line: its name, its parameters and what it does."""
    method = fields(entry)
    parameters = " ".join(_parameter(fields(raw)) for raw in entries(method.get("parameters")))
    return f"  {word(method.get('name'))} {parameters}".rstrip() + f"\n      {word(method.get('doc'))}"


def _parameter(parameter: dict[str, Value]) -> str:
    name = word(parameter.get("name"))
    return f"{name}=…" if parameter.get("required") else f"[{name}={word(parameter.get('default'))}]"


def fields(value: Value) -> dict[str, Value]:
    """`value` if it is a map, else an empty one: answers come from outside."""
    return value if isinstance(value, dict) else {}


def entries(value: Value) -> list[Value]:
    """`value` if it is a list, else an empty one."""
    return value if isinstance(value, list) else []
