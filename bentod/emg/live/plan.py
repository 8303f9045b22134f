"""What a guided collection asks for, by sample index."""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from bentod.emg.recognition import REST
from bentod.errors import BadRequest, nearest

MOST_VALUES = 20_000_000
"""Samples times channels of one collection, which are held in memory: 80 MB."""

MOST_S = 3600.0


@dataclass(frozen=True, slots=True)
class Prompt:
    """One contraction that is asked for; places count from the collection's first sample."""

    label: str
    repetition: int  # from 0
    shown: int  # it is asked for
    hidden: int  # rest is asked for


@dataclass(frozen=True, slots=True)
class Plan:
    """Rest, then each class in turn with a rest after it, again and again."""

    labels: tuple[str, ...]
    hold_s: float
    rest_s: float
    repetitions: int

    def prompts(self, rate_hz: float) -> tuple[Prompt, ...]:
        """All of them, in order of time."""
        each = self.hold_s + self.rest_s
        found = []
        for turn in range(self.repetitions * len(self.labels)):
            repetition, place = divmod(turn, len(self.labels))
            shown = round((self.rest_s + turn * each) * rate_hz)
            found.append(Prompt(self.labels[place], repetition, shown, shown + round(self.hold_s * rate_hz)))
        return tuple(found)

    def seconds(self) -> float:
        """How long it takes."""
        return self.rest_s + self.repetitions * len(self.labels) * (self.hold_s + self.rest_s)

    def samples(self, rate_hz: float) -> int:
        """How many it takes."""
        return math.ceil(self.seconds() * rate_hz)


def check(label: str, known: Collection[str]) -> None:
    """Raises BadRequest: it is neither a class nor rest."""
    if label != REST and label not in known:
        raise BadRequest(f"there is no class '{label}'{nearest(label, (*known, REST))}", "label")


def planned(
    labels: Sequence[str],
    hold_s: float,
    rest_s: float,
    repetitions: int,
    known: Sequence[str],
    rate_hz: float,
    channels: int,
) -> Plan:
    """A plan for `labels`; none: for all that are `known`.

    Raises:
        BadRequest: a class is unknown or stands twice, or it would take too long or too much memory.
    """
    chosen = tuple(label for label in labels if label != REST) or tuple(known)
    strangers = [label for label in chosen if label not in known]
    if strangers:
        raise BadRequest(f"there is no class '{strangers[0]}' (classes: {', '.join(known)})", "classes")
    if len(set(chosen)) != len(chosen):
        raise BadRequest("a class is named twice", "classes")
    plan = Plan(chosen, hold_s, rest_s, repetitions)
    if plan.seconds() > MOST_S:
        raise BadRequest(f"this takes {plan.seconds():.0f} s; the bound is {MOST_S:.0f} s", "repetitions")
    if (values := plan.samples(rate_hz) * channels) > MOST_VALUES:
        raise BadRequest(f"this makes {values:.3g} values; the bound is {MOST_VALUES:.3g}", "repetitions")
    return plan
