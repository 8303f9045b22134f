"""What came of collecting and training, in sentences."""

from collections.abc import Iterator

from bentod.cli import show
from bentod.config_recognition import Recognition
from bentod.config_tables import Emg
from bentod.emg.live.stream import features
from bentod.emg.segmenting import segmenting
from bentod.errors import ConfigError
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
        sessions = found.get("sessions")
        end = "" if sessions == 1 else "s"
        lines.append(f"trained in {seconds:.1f} s on {show.word(sessions)} session{end}")
    return "\n".join(lines)


def _percent(share: Value) -> str:
    return f"{100 * share:.1f} %" if isinstance(share, int | float) else "-"


def check_recognition(emg: Emg) -> None:
    """Raises ConfigError: there is no such classifier, or no such feature of such windows."""
    table = emg.recognition
    if table is None:
        return
    channels = len(table.channels) or len(emg.sites)  # how many the source has is known when it is open
    try:
        cuts = segmenting(table.window_s, table.step_s, emg.rate_hz)
        features(table, channels, emg.rate_hz).check(cuts.length)
    except ConfigError as error:
        raise ConfigError(f"emg.recognition: {error}") from error


def explain_recognition(table: Recognition) -> Iterator[str]:
    """What is recognised, and what it moves."""
    yield (
        f"{table.classifier} tells {len(table.classes)} classes and rest apart, "
        f"every {table.step_s * 1e3:g} ms in the last {table.window_s * 1e3:g} ms."
    )
    for one in table.classes:
        moves = ", ".join(f"{joint} at {share:+.0%}" for joint, share in one.moves.items())
        yield f"  {one.name} moves {moves} of its top speed."
    if table.fusion:
        yield f"What is predicted of their use counts up to {table.fusion.beta:.0%} (fusion)."
    if table.adaptation:
        yield "The classes follow the wearer (adaptation); what they become is not kept."
