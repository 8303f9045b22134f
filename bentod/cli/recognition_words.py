"""What came of collecting and training, in sentences."""

from collections.abc import Iterator

from bentod.cli import show
from bentod.config_recognition import Recognition
from bentod.frames import Value


def collected(told: Value) -> str:
    """A line for each class, and whatever is to be heeded."""
    found = show.fields(told)
    lines = [f"{_class(label, show.fields(of))}" for label, of in show.fields(found.get("classes")).items()]
    return "\n".join([*lines, *map(str, show.entries(found.get("warnings")))])


def _class(label: str, of: dict[str, Value]) -> str:
    moved = [value for value in show.entries(of.get("moved_s")) if isinstance(value, int | float)]
    way = f"labels moved by {min(moved):+.2f} to {max(moved):+.2f} s" if moved else "no labels"
    over = of.get("over_rest")
    strength = f"{over:.1f} times rest" if isinstance(over, int | float) else "strength not known"
    return f"{label}: {strength}, {way}"


def trained(told: Value) -> str:
    """How well classes are told apart."""
    found = show.fields(told)
    accuracy, seconds = found.get("accuracy"), found.get("seconds")
    lines = [
        f"each repetition by the others: {_percent(accuracy)}"
        if accuracy is not None
        else "There is only one repetition: nothing says how well another one would be recognised."
    ]
    lines += [f"  {label}: {_percent(share)}" for label, share in show.fields(found.get("recall")).items()]
    if isinstance(seconds, int | float):
        lines.append(f"trained in {seconds:.1f} s on {show.word(found.get('sessions'))} sessions")
    return "\n".join(lines)


def _percent(share: Value) -> str:
    return f"{100 * share:.1f} %" if isinstance(share, int | float) else "-"


def explain_recognition(table: Recognition) -> Iterator[str]:
    """What is recognised, and what it moves."""
    yield (
        f"{table.classifier} tells {len(table.classes)} classes and rest apart, "
        f"every {table.step_s * 1e3:g} ms in the last {table.window_s * 1e3:g} ms."
    )
    for one in table.classes:
        moves = ", ".join(f"{joint} at {share:+.0%}" for joint, share in one.moves.items())
        yield f"  {one.name} moves {moves} of its top speed."
