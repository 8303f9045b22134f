"""Draws simulated operators: naive, practised, and like the author of the thesis."""

import random
from dataclasses import replace

from sim.people.traits import AUTHOR, NAIVE, PRACTISED, Traits

KINDS = (NAIVE, PRACTISED, NAIVE, AUTHOR)
"""Half are naive, a quarter each practised and like the author, in this order again and again."""

SPREAD = 0.2
"""Standard deviation of the logarithm of what differs between people of one kind; assumed."""


def population(n: int, seed: int) -> list[Traits]:
    """`n` operators, the same for the same `seed`; of a larger population the first `n`."""
    draw = random.Random(f"{seed}/population")
    return [_drawn(KINDS[i % len(KINDS)], i, draw) for i in range(n)]


def _drawn(kind: Traits, number: int, draw: random.Random) -> Traits:
    """Somebody of that kind, with delays, precision, pace, caution and trust of their own."""

    def about(typical: float, least: float = 0.0, most: float = 1e9) -> float:
        return min(max(typical * draw.lognormvariate(0.0, SPREAD), least), most)

    senses, hands, switching = kind.senses, kind.hands, kind.switching
    caution, autonomy = kind.caution, kind.autonomy
    return replace(
        kind,
        name=f"{kind.name} {number + 1}",
        senses=replace(
            senses,
            # The span of Saunders & Knill 2005 for distance, and what the thinnest control adds to it.
            visual_delay=about(senses.visual_delay, 0.13, 0.28),
            prediction=about(senses.prediction, 0.5, 1.0),
        ),
        hands=replace(hands, interval=about(hands.interval, 0.25, 0.55), noise=about(hands.noise)),
        switching=replace(
            switching, choice=about(switching.choice), press=about(switching.press, 0.08, 0.28)
        ),
        caution=replace(caution, margin=about(caution.margin, 0.005, 0.035)),
        autonomy=replace(
            autonomy,
            trust=about(autonomy.trust, 0.0, 0.95),
            wait=about(autonomy.wait),
            confusion=about(autonomy.confusion, 0.0, 0.9),
        ),
    )
