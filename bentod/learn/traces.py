"""What is remembered of a signal: a fading trace of where it has been, its last value, or its last n values.

All start as if the signal had always stood at the first value that is seen: a trace that started at 0 would
spend its first few hundred steps telling of a journey that never was. A value that is not a finite number is
answered with NaN and not remembered; the ticks until the next one that is are counted, so that nothing
changes faster or slower for it.
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray


class Memory(Protocol):
    """What is remembered of one signal."""

    def step(self, x: float, steps: int) -> float:
        """What to say of the signal, which is now at `x`, `steps` ticks (1 or more) after the last call."""
        ...

    def restart(self) -> None:
        """Forget; the next value is the first."""
        ...

    def memory(self) -> NDArray[np.float64]:
        """A copy of all that is remembered."""
        ...

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Remember it again. Raises ValueError: it is not that of such a memory."""
        ...


class _Last:
    """One value, and the ticks since it was seen, not counting those of the step that is asked about."""

    def __init__(self) -> None:
        self._value = math.nan
        self._waited = 0

    def restart(self) -> None:
        """Forget; the next value is the first."""
        self._value, self._waited = math.nan, 0

    def memory(self) -> NDArray[np.float64]:
        """The value and the ticks."""
        return np.array([self._value, self._waited], dtype=np.float64)

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Remember them again. Raises ValueError: they are not such."""
        if memory.shape != (2,) or not (memory[1] >= 0 and math.isfinite(memory[1])):
            raise ValueError("This is not a value and how long it was waited for.")
        self._value, self._waited = float(memory[0]), int(memory[1])

    def _elapsed(self, x: float, steps: int) -> int:
        """Ticks since the value; 0 when there is none or `x` is not a number that could follow it."""
        if not math.isfinite(x):
            self._waited += steps
            return 0
        elapsed, self._waited = self._waited + steps, 0
        return 0 if math.isnan(self._value) else elapsed


class HistoryTrace(_Last):
    """H_{t+1} = (1 − ξ) θ_{t+1} + ξ H_t, thesis (4.7) and (5.5); with ξ^n for ξ after n ticks."""

    def __init__(self, decay: float) -> None:
        super().__init__()
        if not 0 <= decay < 1:
            raise ValueError(f"The decay of a history trace must be at least 0 and below 1, not {decay}.")
        self._decay = decay

    def step(self, x: float, steps: int = 1) -> float:
        """The trace, now that the signal is at `x`."""
        elapsed = self._elapsed(x, steps)
        if not math.isfinite(x):
            return math.nan
        xi = self._decay ** (elapsed or 1)
        self._value = (1 - xi) * x + xi * (self._value if elapsed else x)
        return self._value


class Difference(_Last):
    """How much the signal has changed per tick since it was last seen."""

    def step(self, x: float, steps: int = 1) -> float:
        """The change per tick to `x`."""
        elapsed = self._elapsed(x, steps)
        if not math.isfinite(x):
            return math.nan
        change = (x - self._value) / elapsed if elapsed else 0.0
        self._value = x
        return change


class Delay:
    """The signal as it was n ticks ago; in ticks that were missed it is taken to have stood still."""

    def __init__(self, ticks: int) -> None:
        self._past = np.full(ticks + 1, math.nan)
        self._now = 0  # place of the newest value
        self._begun = False

    def step(self, x: float, steps: int = 1) -> float:
        """The value n ticks before this one, in which the signal is at `x`."""
        if not self._begun:
            if math.isfinite(x):
                self._past.fill(x)
                self._begun = True
            return x if self._begun else math.nan
        for _ in range(min(steps, len(self._past)) - 1):
            self._append(self._past[self._now])
        self._append(x if math.isfinite(x) else math.nan)
        return float(self._past[(self._now + 1) % len(self._past)])

    def restart(self) -> None:
        """Forget; the next value is the first."""
        self._past.fill(math.nan)
        self._now, self._begun = 0, False

    def memory(self) -> NDArray[np.float64]:
        """Whether it has begun, the place of the newest value, and the values."""
        return np.array([self._begun, self._now, *self._past.tolist()], dtype=np.float64)

    def recall(self, memory: NDArray[np.float64]) -> None:
        """Remember it again. Raises ValueError: it is of another delay."""
        ticks = len(self._past)
        if memory.shape != (ticks + 2,) or memory[0] not in (0, 1) or memory[1] not in range(ticks):
            raise ValueError(f"This is not what a delay of {ticks - 1} ticks remembers.")
        self._begun, self._now = bool(memory[0]), int(memory[1])
        self._past = memory[2:].astype(np.float64)

    def _append(self, x: float) -> None:
        self._now = (self._now + 1) % len(self._past)
        self._past[self._now] = x


class HistoryTraces:
    """History traces of several signals θ with one decay ξ."""

    def __init__(self, decay: float) -> None:
        HistoryTrace(decay)  # refuses what is no decay
        self._decay = decay
        self._traces: list[HistoryTrace] = []

    def step(self, signals: Sequence[float]) -> list[float]:
        """The traces after `signals` (one unit, always the same number of them) have been observed."""
        self._traces = self._traces or [HistoryTrace(self._decay) for _ in signals]
        return [trace.step(theta) for trace, theta in zip(self._traces, signals, strict=True)]

    def restart(self) -> None:
        """Forget; the next observation is the first."""
        self._traces = []
