"""Slow learners with a step size for each feature, number by number; each returns P_0 … P_T."""

import math

from tests.learn.algorithms.journeys import Journey, Numbers, error, told
from tests.learn.algorithms.oracles_fixed import inner


def tidbd(experience: Journey, w: Numbers, alpha: float, theta: float) -> Numbers:
    """TIDBD(λ) as printed, with the whole step divided where it would overshoot."""
    n = len(w)
    beta, h, z = [math.log(alpha)] * n, [0.0] * n, [0.0] * n
    decay = 0.0
    answers = [inner(w, experience.phis[0])]
    for phi, phi_next, arrival in experience.transitions():
        v, v_next = inner(w, phi), inner(w, phi_next)
        delta = error(arrival, v, v_next)
        alphas = []
        for i in range(n):
            beta[i] = min(max(beta[i] + theta * delta * phi[i] * h[i], -math.log(1e20)), math.log(1e20))
            alphas.append(math.exp(beta[i]))
            z[i] = decay * z[i] + phi[i]
        share = max(1.0, sum(alphas[i] * z[i] * phi[i] for i in range(n)))
        w = w.copy()
        for i in range(n):
            a = alphas[i] / share
            w[i] += a * delta * z[i]
            h[i] = h[i] * max(0.0, 1 - a * phi[i] * z[i]) + a * delta * z[i]
        decay = arrival.gamma * arrival.lam
        answers.append(inner(w, phi_next))
    return answers


def autostep(experience: Journey, w: Numbers, alpha: float, theta: float, tau: float) -> Numbers:
    """Autostep for TD(λ)."""
    n = len(w)
    alphas, eta, h, z = [alpha] * n, [0.0] * n, [0.0] * n, [0.0] * n
    decay = 0.0
    answers = [inner(w, experience.phis[0])]
    for phi, phi_next, arrival in experience.transitions():
        v, v_next = inner(w, phi), inner(w, phi_next)
        delta = error(arrival, v, v_next)
        for i in range(n):
            z[i] = decay * z[i] + phi[i]
            g = delta * phi[i] * h[i]
            eta[i] = max(abs(g), eta[i] + alphas[i] * phi[i] * z[i] / tau * (abs(g) - eta[i]))
            if eta[i] > 0:
                alphas[i] *= math.exp(theta * g / eta[i])
        share = sum(alphas[i] * z[i] * (phi[i] - arrival.gamma * phi_next[i]) for i in range(n))
        alphas = [a / max(1.0, share) for a in alphas]
        w = [w[i] + alphas[i] * delta * z[i] for i in range(n)]
        for i in range(n):
            h[i] = h[i] * max(0.0, 1 - alphas[i] * phi[i] * z[i]) + alphas[i] * delta * z[i]
        decay = arrival.gamma * arrival.lam
        answers.append(inner(w, phi_next))
    return answers


class SwiftTD:
    """SwiftTD in the order of perceiving: first learn from the step before, then take in the new state."""

    def __init__(
        self, w: Numbers, alpha: float, theta: float, eta: float, decay: float, least: float
    ) -> None:
        n = len(w)
        self.n, self.w, self.theta, self.eta, self.decay, self.least = n, w.copy(), theta, eta, decay, least
        self.beta = [min(math.log(alpha), math.log(eta))] * n
        self.z, self.z_delta, self.z_bar = [0.0] * n, [0.0] * n, [0.0] * n
        self.p, self.h, self.h_old, self.h_temp = [0.0] * n, [0.0] * n, [0.0] * n, [0.0] * n
        self.moved = [0.0] * n
        self.v_old = self.v_delta = 0.0

    def perceive(self, phi: Numbers, reward: float, gamma: float, lam: float) -> float:
        v = inner(self.w, phi)
        delta = reward + gamma * v - self.v_old
        for i in range(self.n):
            self.moved[i] = delta * self.z[i] - self.z_delta[i] * self.v_delta
            self.w[i] += self.moved[i]
            self.beta[i] += self.theta / math.exp(self.beta[i]) * (delta - self.v_delta) * self.p[i]
            self.beta[i] = min(max(self.beta[i], math.log(self.least)), math.log(self.eta))
            self.h_old[i] = self.h[i]
            self.h[i] = self.h_temp[i] + delta * self.z_bar[i] - self.z_delta[i] * self.v_delta
            for trace in (self.z, self.p, self.z_bar):
                trace[i] *= gamma * lam
        self.look(phi)
        self.v_old = v
        return inner(self.w, phi)

    def look(self, phi: Numbers) -> None:
        self.v_delta = inner(self.moved, phi)
        rate = sum(math.exp(b) * f * f for b, f in zip(self.beta, phi, strict=True))
        known = inner(self.z, phi)
        for i, f in enumerate(phi):
            self.z_delta[i] = self.eta / max(self.eta, rate) * math.exp(self.beta[i]) * f
            self.z[i] += self.z_delta[i] * (1 - known)
            self.p[i] += self.h_old[i] * f
            self.z_bar[i] += self.z_delta[i] * (1 - known - self.z_bar[i] * f)
            self.h_temp[i] = (
                self.h[i]
                - self.h_old[i] * f * (self.z[i] - self.z_delta[i])
                - self.h[i] * self.z_delta[i] * f
            )
            if rate > self.eta and f != 0:
                self.h[i] = self.h_old[i] = self.h_temp[i] = self.z_bar[i] = 0.0
                self.beta[i] += math.log(self.decay) * f * f


def swifttd(
    experience: Journey, w: Numbers, alpha: float, theta: float, eta: float, decay: float, least: float
) -> Numbers:
    learner = SwiftTD(w, alpha, theta, eta, decay, least)
    answers = [learner.perceive(experience.phis[0], 0.0, 0.0, 0.0)]
    for phi, phi_next, arrival in experience.transitions():
        reward = told(arrival, inner(learner.w, phi), inner(learner.w, phi_next))
        answers.append(learner.perceive(phi_next, reward, arrival.gamma, arrival.lam))
    return answers


def descent(experience: Journey, w: float, beta: float, targets: Numbers) -> tuple[float, float]:
    """w_T and z_{T−1} of (5.2)–(5.4) with a single feature, α = exp β, and each R + γv(S') given.

    What SwiftTD's h and z̄ are the derivatives of, by β.
    """
    alpha, z, w_before, decay = math.exp(beta), 0.0, w, 0.0
    for (phi, _, arrival), target in zip(experience.transitions(), targets, strict=True):
        f = phi[0]
        z = decay * z + alpha * f * (1 - decay * z * f)
        w_before, w = w, w + (target - w_before * f) * z + alpha * (w_before - w) * f * f
        decay = arrival.gamma * arrival.lam
    return w, z
