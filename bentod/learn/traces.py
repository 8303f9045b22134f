"""History traces: a fading memory of where a joint has been, thesis equation (5.5)."""

from collections.abc import Sequence


class HistoryTraces:
    """H_{t+1} = (1 − ξ) θ_{t+1} + ξ H_t, for several signals θ with one decay ξ.

    The first observation starts each trace where its signal is: a trace that started at 0 would spend its
    first few hundred steps telling of a journey that never was.
    """

    def __init__(self, decay: float) -> None:
        if not 0 <= decay < 1:
            raise ValueError(f"The decay of a history trace must be at least 0 and below 1, not {decay}.")
        self._decay = decay
        self._traces: list[float] | None = None

    def step(self, signals: Sequence[float]) -> list[float]:
        """The traces after `signals` (one unit, always the same number of them) have been observed."""
        xi = self._decay
        previous = self._traces or signals
        self._traces = [(1 - xi) * theta + xi * h for theta, h in zip(signals, previous, strict=True)]
        return self._traces.copy()

    def restart(self) -> None:
        """Forget; the next observation is the first."""
        self._traces = None
