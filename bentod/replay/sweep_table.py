"""The outcomes of a sweep as rows: a table for the eye, and one for programs."""

import csv
import io
from collections.abc import Iterator, Sequence

from bentod.replay.sweep import Outcome, best, shown

WIDEST = 6
"""Functions that have a column of their own in the table for the eye."""

RELATIVE = "of live"


def names(outcomes: Sequence[Outcome]) -> list[str]:
    """The functions whose errors are known, in the order in which they come."""
    return list(dict.fromkeys(it.name for outcome in outcomes for it in outcome.measures))


def table(outcomes: Sequence[Outcome]) -> Iterator[list[str]]:
    """A head, and one row a combination: its parameters, its relative error, the first functions' errors."""
    keys = list(outcomes[0].point.changes) if outcomes else []
    columns = names(outcomes)[:WIDEST]
    yield [*keys, RELATIVE, *columns]
    for outcome in outcomes:
        changes = [shown(value) for value in outcome.point.changes.values()]
        if outcome.failed:
            yield [*changes, f"failed: {outcome.failed}", *("" for _ in columns)]
            continue
        errors = {it.name: f"{it.again:.4g}" for it in outcome.measures}
        yield [*changes, f"{outcome.relative:.4f}", *(errors.get(name, "–") for name in columns)]


def sentences(outcomes: Sequence[Outcome]) -> list[str]:
    """What the numbers are, and which are the best."""
    told = [
        "Errors are root mean squares against what came to pass, each in its own unit; "
        f"'{RELATIVE}' is the geometric mean of their shares of those live."
    ]
    if (hidden := len(names(outcomes)) - WIDEST) > 0:
        told.append(f"{hidden} functions more are in the CSV (--out) and in '{RELATIVE}', not in this table.")
    if failed := sum(bool(outcome.failed) for outcome in outcomes):
        told.append(f"{failed} of {len(outcomes)} combinations failed.")
    if found := best(outcomes):
        told.append(f"The best is {found.point}: {found.relative:.4f} of the errors live.")
    else:
        told.append("No combination predicts what was predicted live, so there is no error to compare.")
    return told


def as_csv(outcomes: Sequence[Outcome]) -> str:
    """One row a combination and function, every digit kept; a failed one has a row with the reason."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    keys = list(outcomes[0].point.changes) if outcomes else []
    writer.writerow([*keys, "function", "rmse", "rmse_live", "ticks", "equal_ticks", "failed"])
    for outcome in outcomes:
        changes = [shown(value) for value in outcome.point.changes.values()]
        for it in outcome.measures:
            writer.writerow(
                [*changes, it.name, repr(it.again), repr(it.live), outcome.ticks, outcome.equal, ""]
            )
        if not outcome.measures:
            writer.writerow([*changes, "", "", "", outcome.ticks, outcome.equal, outcome.failed])
    return text.getvalue()
