"""Slow, dense, line-by-line learners of one GVF, as the thesis prints them; every vector is a full one."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Stream:
    """φ_0 … φ_T and R_1 … R_T, with a step size α_t for each transition t → t + 1."""

    phis: Sequence[Vector]
    rewards: Sequence[float]
    alphas: Sequence[float]

    def transitions(self) -> Iterator[tuple[Vector, Vector, float, float]]:
        return zip(self.phis, self.phis[1:], self.rewards, self.alphas, strict=False)


def equations_5_2_to_5_4(stream: Stream, w: Vector, gamma: float, lam: float) -> list[Vector]:
    """w_0 … w_T."""
    ws = [w.copy()]
    w_before = w.copy()
    e = np.zeros_like(w)
    for phi, phi_next, reward, alpha in stream.transitions():
        delta = reward + gamma * (w @ phi_next) - w_before @ phi
        e = gamma * lam * e + alpha * phi - alpha * gamma * lam * (e @ phi) * phi
        w_after = w + delta * e + alpha * (w_before @ phi - w @ phi) * phi
        w_before, w = w, w_after
        ws.append(w)
    return ws


def algorithm_1(stream: Stream, w: Vector, gamma: float, lam: float) -> list[Vector]:
    """w_0 … w_T within one episode, with the lines in the order they are printed in."""
    ws = [w.copy()]
    e = np.zeros_like(w)
    v_old = w @ stream.phis[0]
    for phi, phi_next, reward, alpha in stream.transitions():
        change = w @ phi - v_old
        v_old = w @ phi_next
        delta = reward + gamma * (w @ phi_next) - w @ phi
        e = e + alpha * (1 - e @ phi) * phi
        w = w + delta * e + change * (e - alpha * phi)
        e = gamma * lam * e
        ws.append(w)
    return ws


def step_size_outside_the_trace(stream: Stream, w: Vector, gamma: float, lam: float) -> list[Vector]:
    """w_0 … w_T as in Sutton & Barto 2018, section 12.5: no α in the trace z, but in the update."""
    ws = [w.copy()]
    z = np.zeros_like(w)
    v_old = w @ stream.phis[0]
    for phi, phi_next, reward, alpha in stream.transitions():
        v, v_next = w @ phi, w @ phi_next
        delta = reward + gamma * v_next - v
        z = gamma * lam * z + (1 - alpha * gamma * lam * (z @ phi)) * phi
        w = w + alpha * (delta + v - v_old) * z - alpha * (v - v_old) * phi
        v_old = v_next
        ws.append(w)
    return ws


def mixed_forms(stream: Stream, w: Vector, gamma: float, lam: float) -> list[Vector]:
    """The wrong rule: δ of Algorithm 1 with the last term of (5.4)."""
    ws = [w.copy()]
    w_before = w.copy()
    e = np.zeros_like(w)
    for phi, phi_next, reward, alpha in stream.transitions():
        delta = reward + gamma * (w @ phi_next) - w @ phi
        e = gamma * lam * e + alpha * phi - alpha * gamma * lam * (e @ phi) * phi
        w_after = w + delta * e + alpha * (w_before @ phi - w @ phi) * phi
        w_before, w = w, w_after
        ws.append(w)
    return ws


def late_v_old(stream: Stream, w: Vector, gamma: float, lam: float) -> list[Vector]:
    """The other wrong rule: Algorithm 1 with v_old taken after the update of w."""
    ws = [w.copy()]
    e = np.zeros_like(w)
    v_old = w @ stream.phis[0]
    for phi, phi_next, reward, alpha in stream.transitions():
        change = w @ phi - v_old
        delta = reward + gamma * (w @ phi_next) - w @ phi
        e = e + alpha * (1 - e @ phi) * phi
        w = w + delta * e + change * (e - alpha * phi)
        e = gamma * lam * e
        v_old = w @ phi_next
        ws.append(w)
    return ws


def online_lambda_return(stream: Stream, w: Vector, gamma: float, lam: float) -> list[Vector]:
    """w_0 … w_T by the forward view (van Seijen & Sutton 2014, section 4): each horizon starts from w_0."""
    ws = [w.copy()]
    for horizon in range(1, len(stream.phis)):
        fresh = w.copy()
        for t in range(horizon):
            goal = _truncated_lambda_return(stream, ws, t, horizon, gamma, lam)
            phi = stream.phis[t]
            fresh = fresh + stream.alphas[t] * (goal - fresh @ phi) * phi
        ws.append(fresh)
    return ws


def _truncated_lambda_return(
    stream: Stream, ws: Sequence[Vector], t: int, horizon: int, gamma: float, lam: float
) -> float:
    longest = horizon - t
    total = 0.0
    for n in range(1, longest + 1):
        rewards = sum(gamma**i * stream.rewards[t + i] for i in range(n))
        n_step = rewards + gamma**n * float(ws[t + n - 1] @ stream.phis[t + n])
        total += (lam ** (n - 1) if n == longest else (1 - lam) * lam ** (n - 1)) * n_step
    return total


@dataclass(frozen=True)
class Journey:
    """φ_0 … φ_T, and for each transition R_{t+1} (NaN: not observed), γ_{t+1} and λ_{t+1}; one α."""

    phis: Sequence[Vector]
    rewards: Sequence[float]
    gammas: Sequence[float]
    lams: Sequence[float]
    alpha: float

    def transitions(self) -> Iterator[tuple[Vector, Vector, float, float, float]]:
        return zip(self.phis, self.phis[1:], self.rewards, self.gammas, self.lams, strict=False)


@dataclass(frozen=True)
class Travelled:
    """What a learner has at φ_0 … φ_T: w and z, the trace without α, and δ of Algorithm 1 on the way."""

    ws: Sequence[Vector]
    zs: Sequence[Vector]
    deltas: Sequence[float]


def accumulating_td(journey: Journey, w: Vector) -> Travelled:
    """The lines (2.2)–(2.4), with γ and λ of the state; δ counts as 0 where R was not observed."""
    z = journey.phis[0].copy()
    ws, zs, deltas = [w.copy()], [z], [np.nan]
    for phi, phi_next, reward, gamma, lam in journey.transitions():
        delta = reward + gamma * (w @ phi_next) - w @ phi
        w = w + journey.alpha * (delta if np.isfinite(reward) else 0) * z
        z = gamma * lam * z + phi_next
        ws.append(w)
        zs.append(z)
        deltas.append(float(delta) if np.isfinite(reward) else np.nan)
    return Travelled(ws, zs, deltas)


def true_online(journey: Journey, w: Vector) -> Travelled:
    """Algorithm 1, with γ and λ of the state; where R was not observed δ counts as 0, Δv does not."""
    alpha = journey.alpha
    e = alpha * journey.phis[0]
    v_old = w @ journey.phis[0]
    ws, zs, deltas = [w.copy()], [e / alpha], [np.nan]
    for phi, phi_next, reward, gamma, lam in journey.transitions():
        change = w @ phi - v_old
        v_old = w @ phi_next
        delta = reward + gamma * (w @ phi_next) - w @ phi
        w = w + (delta if np.isfinite(reward) else 0) * e + change * (e - alpha * phi)
        e = gamma * lam * e
        e = e + alpha * (1 - e @ phi_next) * phi_next
        ws.append(w)
        zs.append(e / alpha)
        deltas.append(float(delta) if np.isfinite(reward) else np.nan)
    return Travelled(ws, zs, deltas)
