"""The variance of the λ-return, learned directly: a second general value function beside the one it is about.

Sherstan, Bennett, Young, Ashley, White, White & Sutton, "Comparing direct and indirect
temporal-difference methods for estimating the variance of the return", UAI 2018. Of the λ-return G^λ
from a state, whose value is J,

    G^λ_t − J(S_t) = δ_t + γ_{t+1} λ_{t+1} (G^λ_{t+1} − J(S_{t+1})).

If the values are right, the two terms are uncorrelated, and squaring gives a Bellman equation again:

    Var[G^λ_t] = E[δ_t² + (γ_{t+1} λ_{t+1})² Var[G^λ_{t+1}]].

So the variance is itself a value, with δ² for its cumulant and (γλ)² for its discount, and any learner
can learn it. With λ = 1 it is the variance of the return. While J is still wrong, δ² counts its errors
too, and the answer is rather too large than too small.
"""

import math

from bentod.contracts import Arrival


def companion(delta: float, arrival: Arrival, lam: float) -> Arrival:
    """What a transition brings to the variance: R = δ², γ = (γλ)².

    `delta`: δ_t of the learner of the value; NaN stays NaN, and teaches nothing. `arrival`: what it learned
    from. `lam`: λ with which the variance is learned. On policy.
    """
    return Arrival(delta * delta, discount(arrival.gamma, arrival.lam), lam)


def discount(gamma: float, lam: float) -> float:
    """The discount of the variance, (γλ)²."""
    return (gamma * lam) ** 2


def spread(variance: float) -> float:
    """The standard deviation; a learned variance may be a little below 0, where it is taken to be 0."""
    return math.sqrt(max(0.0, variance))
