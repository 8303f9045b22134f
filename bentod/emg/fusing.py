"""A classifier's likelihoods and what is predicted of each class, weighed together (thesis 6.2)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bentod.config_adaptation import Fusion
from bentod.emg.recognition import REST, Fused

FAINTEST = 0.02
"""Least predicted use of all movements together, 0..1, from which anything can be said of one of them."""


@dataclass(frozen=True, slots=True)
class Foreseen:
    """What is predicted of the classes, and how far that can be believed."""

    use: Mapping[str, float]  # P, 0..1, by class: the share of the near future that is spent in it
    confidence: float  # C, 0..1


def fuse(labels: Sequence[str], likelihoods: Sequence[float], foreseen: Foreseen, fusion: Fusion) -> Fused:
    """Likelihood_i = β C_t P_i + (1 − β C_t) L_i (6.6), of movements among one another.

    Whether anything moves is for the muscles alone to say: P of rest is L of rest, and the others share what
    is left in proportion to their predicted use. Where the muscles rest, nothing is added at all.
    """
    known = dict(zip(labels, likelihoods, strict=True))
    unaided = max(known, key=known.__getitem__)
    use = {label: min(max(foreseen.use.get(label, 0.0), 0.0), 1.0) for label in labels if label != REST}
    total = sum(use.values())
    weight = fusion.beta * min(max(foreseen.confidence, 0.0), 1.0)
    if unaided == REST or not total >= FAINTEST or not weight > 0:  # so that NaN has no weight either
        return Fused(0.0, known, unaided)
    known = _softened(known, fusion.softness)
    moving = 1 - known.get(REST, 0.0)
    told = {REST: known.get(REST, 0.0)} | {label: moving * one / total for label, one in use.items()}
    weighed = {label: weight * told[label] + (1 - weight) * known[label] for label in labels}
    return Fused(weight, weighed, unaided)


def _softened(likelihoods: Mapping[str, float], softness: float) -> dict[str, float]:
    """In the same order, but nearer to one another."""
    powers = {label: one ** (1 / softness) for label, one in likelihoods.items()}
    total = sum(powers.values())
    return {label: one / total for label, one in powers.items()}
