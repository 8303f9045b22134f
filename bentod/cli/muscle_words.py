"""What drives a group, in sentences."""

from collections.abc import Iterator

from bentod.config_sites import CoContraction, Pair, Pulse, SingleSite


def explain_scheme(table: Pair | SingleSite) -> Iterator[str]:
    """How muscles drive and toggle one group."""
    drives = _pair(table) if isinstance(table, Pair) else _single(table)
    toggles = ", ".join(_toggles(table))
    yield f"{drives} the group {table.group}{', ' + toggles if toggles else ''}."


def _pair(pair: Pair) -> str:
    if pair.rule == "difference":
        return f"{pair.positive} minus {pair.negative} drives"
    which = "first" if pair.rule == "first_over" else "stronger"
    return f"{pair.positive} against {pair.negative}, whichever is {which}, drives"


def _single(single: SingleSite) -> str:
    if single.rule == "alternate":
        return f"{single.site}, to and fro in turn, drives"
    other = "negative" if single.weak == "positive" else "positive"
    return f"{single.site}, {single.weak} when weak and {other} when strong, drives"


def _toggles(table: Pair | SingleSite) -> Iterator[str]:
    both_ways = table.toggle is not None and table.toggle == table.toggle_back
    if table.toggle:
        yield f"toggled by {table.toggle}"
    if table.toggle_back:
        how = f" for {table.long_s:g} s" if both_ways else ""
        yield f"toggled back by {table.toggle_back}{how}"
    if isinstance(table, Pair):
        yield from _contractions(table.co_contraction, table.pulse)


def _contractions(squeeze: CoContraction | None, pulse: Pulse | None) -> Iterator[str]:
    back = {"forward": "", "backward": " back"}
    if squeeze:
        yield f"toggled{back[squeeze.direction]} by a squeeze of both"
    if pulse:
        yield f"toggled{back[pulse.direction]} by a pulse of {pulse.site}"
