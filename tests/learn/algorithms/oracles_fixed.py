"""Slow learners with one step size, number by number as the papers print them; each returns P_0 … P_T."""

from tests.learn.algorithms.journeys import Journey, Numbers, error, told


def inner(a: Numbers, b: Numbers) -> float:
    return sum(x * y for x, y in zip(a, b, strict=True))


def td(experience: Journey, w: Numbers, alpha: float, kind: str) -> Numbers:
    """(2.2)–(2.5) and (4.3), with the γλ of the state that is left."""
    n = len(w)
    e = [0.0] * n
    decay = 0.0
    answers = [inner(w, experience.phis[0])]
    for phi, phi_next, arrival in experience.transitions():
        v, v_next = inner(w, phi), inner(w, phi_next)
        delta = error(arrival, v, v_next)
        active = max(1, sum(x != 0 for x in phi))
        for i in range(n):
            if kind == "accumulating":
                e[i] = arrival.rho * (decay * e[i] + alpha * phi[i])
            elif kind == "replacing":
                e[i] = arrival.rho * (alpha if phi[i] == 1 else decay * e[i])
            else:
                e[i] = arrival.rho * (decay * e[i] + alpha * phi[i] / active)
        w = [w[i] + delta * e[i] for i in range(n)]
        decay = arrival.gamma * arrival.lam
        answers.append(inner(w, phi_next))
    return answers


def algorithm_1(experience: Journey, w: Numbers, alpha: float) -> Numbers:
    """The thesis' Algorithm 1, line by line."""
    n = len(w)
    e = [0.0] * n
    v_old = inner(w, experience.phis[0])
    answers = [v_old]
    for phi, phi_next, arrival in experience.transitions():
        change = inner(w, phi) - v_old
        v_old = inner(w, phi_next)
        delta = error(arrival, inner(w, phi), inner(w, phi_next))
        before = inner(e, phi)
        e = [e[i] + alpha * (1 - before) * phi[i] for i in range(n)]
        w = [w[i] + delta * e[i] + change * (e[i] - alpha * phi[i]) for i in range(n)]
        e = [arrival.gamma * arrival.lam * e[i] for i in range(n)]
        answers.append(inner(w, phi_next))
    return answers


def equations_5(experience: Journey, w: Numbers, alpha: float) -> Numbers:
    """(5.2)–(5.4), with w_{t−1} itself rather than its value."""
    n = len(w)
    e = [0.0] * n
    w_before, decay = w, 0.0
    answers = [inner(w, experience.phis[0])]
    for phi, phi_next, arrival in experience.transitions():
        v_next = inner(w, phi_next)
        delta = told(arrival, inner(w, phi), v_next) + arrival.gamma * v_next - inner(w_before, phi)
        before = inner(e, phi)
        e = [decay * e[i] + alpha * phi[i] - alpha * decay * before * phi[i] for i in range(n)]
        off = inner(w_before, phi) - inner(w, phi)
        w_before, w = w, [w[i] + delta * e[i] + alpha * off * phi[i] for i in range(n)]
        decay = arrival.gamma * arrival.lam
        answers.append(inner(w, phi_next))
    return answers


def forward_view(experience: Journey, w: Numbers, alpha: float) -> Numbers:
    """The on-line λ-return algorithm (van Seijen et al. 2016): at each horizon all again, from w_0 on.

    The state k bootstraps from w_{k−1}; the last one before the horizon does so whole.
    """
    ws = [w]
    for horizon in range(1, len(experience.phis)):
        fresh = w
        for t in range(horizon):
            goal = _return(experience, ws, t, horizon)
            error = goal - inner(fresh, experience.phis[t])
            fresh = [x + alpha * error * f for x, f in zip(fresh, experience.phis[t], strict=True)]
        ws.append(fresh)
    return [inner(x, phi) for x, phi in zip(ws, experience.phis, strict=True)]


def _return(experience: Journey, ws: list[Numbers], t: int, horizon: int) -> float:
    arrival = experience.arrivals[t]
    value = inner(ws[t], experience.phis[t + 1])
    if t + 1 == horizon:
        return arrival.cumulant + arrival.gamma * value
    later = _return(experience, ws, t + 1, horizon)
    return arrival.cumulant + arrival.gamma * ((1 - arrival.lam) * value + arrival.lam * later)


def gtd(experience: Journey, w: Numbers, alpha: float, beta: float) -> Numbers:
    """GTD(λ) as in Maei 2011."""
    n = len(w)
    e, h = [0.0] * n, [0.0] * n
    decay = 0.0
    answers = [inner(w, experience.phis[0])]
    for phi, phi_next, arrival in experience.transitions():
        v, v_next = inner(w, phi), inner(w, phi_next)
        delta = error(arrival, v, v_next)
        e = [arrival.rho * (decay * e[i] + phi[i]) for i in range(n)]
        rest = arrival.gamma * (1 - arrival.lam) * inner(e, h)
        seen = inner(h, phi)
        w = [w[i] + alpha * (delta * e[i] - rest * phi_next[i]) for i in range(n)]
        h = [h[i] + beta * (delta * e[i] - seen * phi[i]) for i in range(n)]
        decay = arrival.gamma * arrival.lam
        answers.append(inner(w, phi_next))
    return answers
