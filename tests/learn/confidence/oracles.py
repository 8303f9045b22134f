"""Measures of confidence of one GVF, slow and dense, as the thesis prints them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Features

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Experience:
    """Active features of each step, and for each transition |δ|/Range; NaN where nothing was learned."""

    features: Sequence[Features]
    errors: Sequence[float]
    size: int


def equation_6_5(experience: Experience, eta: float, sigma: float) -> tuple[list[Vector], list[float]]:
    """ζ_t and U_t at every step, element by element. φ is divided by the number of active features."""
    zeta = [1.0] * experience.size
    zetas, uncertainties = [np.array(zeta)], [_inner(zeta, experience.features[0])]
    for before, now, error in zip(
        experience.features, experience.features[1:], experience.errors, strict=False
    ):
        wrong = 0.0 if np.isnan(error) else error - _inner(zeta, before)
        zeta = [
            element + (eta * wrong if i in before else 0.0) + sigma * (1.0 - element)
            for i, element in enumerate(zeta)
        ]
        zetas.append(np.array(zeta))
        uncertainties.append(_inner(zeta, now))
    return zetas, uncertainties


def equation_6_5_as_printed(
    experience: Experience, eta: float, sigma: float
) -> tuple[list[Vector], list[float]]:
    """The same with (6.4), ζ_0 = 1/k, and φ of ones: for a constant number of active features k."""
    zeta_0 = np.full(experience.size, 1 / len(experience.features[0]))
    phis = [np.bincount(it, minlength=experience.size).astype(np.float64) for it in experience.features]
    zeta = zeta_0.copy()
    zetas, uncertainties = [zeta], [float(zeta @ phis[0])]
    for phi, phi_next, error in zip(phis, phis[1:], experience.errors, strict=False):
        zeta = zeta + eta * (error - zeta @ phi) * phi + sigma * (zeta_0 - zeta)
        zetas.append(zeta)
        uncertainties.append(float(zeta @ phi_next))
    return zetas, uncertainties


def returns(rewards: Vector, gammas: Vector, predictions: Vector, tail: float) -> Vector:
    """G_t by summation until what is left weighs `tail` or less, and is P there; NaN where that never comes.

    `rewards`, `gammas`: R_t and γ_t as they came with P_t = `predictions`; those of t = 0 are not used.
    """
    return np.array([_return(t, rewards, gammas, predictions, tail) for t in range(len(rewards))])


def _return(t: int, rewards: Vector, gammas: Vector, predictions: Vector, tail: float) -> float:
    total, worth = 0.0, 1.0
    for i in range(t + 1, len(rewards)):
        total += worth * rewards[i]
        worth *= gammas[i]
        if worth <= tail:
            return float(total + worth * predictions[i])
    return float("nan")


def _inner(zeta: Sequence[float], features: Features) -> float:
    return float(sum(zeta[i] for i in features) / len(features))
