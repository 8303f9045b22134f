"""A guided collection under way: which prompt is due, and the samples that came meanwhile."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from bentod.emg.live.plan import Plan, Prompt
from bentod.emg.recognition import REST
from bentod.frames import Samples

PATIENCE_S = 0.5
"""s for which the source may not be alive before the collection ends: what is missing for less is missing."""


@dataclass(frozen=True, slots=True)
class Session:
    """What was collected: raw samples (V, shape (n, channels), NaN where missing), and what was asked."""

    rate_hz: float
    samples: Samples
    prompts: tuple[Prompt, ...]


@dataclass(frozen=True, slots=True)
class Told:
    """What the person is asked for from now on."""

    label: str
    repetition: int  # from 1; 0 at rest
    of: int
    seconds: float

    @property
    def text(self) -> str:
        """As a sentence."""
        if self.label == REST:
            return f"Rest, {self.seconds:.3g} s."
        return f"{self.label.replace('_', ' ')}, {self.seconds:.3g} s ({self.repetition} of {self.of})."


Ended: TypeAlias = Callable[[Session | None, str], None]
"""Told once: what was collected, or None and why there is nothing."""


class Collection:
    """Counts samples, not seconds, so a tick that comes late shifts nothing in what is kept."""

    def __init__(self, plan: Plan, rate_hz: float, channels: Sequence[int], ended: Ended) -> None:
        self.plan = plan
        self.prompted = REST
        self.over = False
        self.why = ""
        """Why it ended without a result; empty if it has one, or goes on."""
        self._rate_hz = rate_hz
        self._channels = list(channels)
        self._prompts = plan.prompts(rate_hz)
        self._length = plan.samples(rate_hz)
        self._samples = np.full((self._length, len(self._channels)), np.nan, np.float32)
        self._ended = ended
        self._begun = -1  # index of the source's sample that is the first of this collection
        self._stage = -1  # number of the change of prompts that was told last
        self._dead_since: float | None = None

    def take(self, next_index: int, samples: Samples, now: float, problem: str) -> list[Told]:
        """Keep what came, and return what is to be prompted now.

        `next_index`: after the newest of `samples` (V, shape (n, all channels)); `problem`: why the source
        is not alive at `now` (monotonic s), empty if it is.
        """
        if self._begun < 0:
            self._begun = next_index
            return self._tell(0)
        self._dead_since = (self._dead_since or now) if problem else None
        if self._dead_since is not None and now - self._dead_since > PATIENCE_S:
            self.cancel(problem)
            return []
        self._keep(next_index - self._begun, samples)
        at = next_index - self._begun
        if at >= self._length:
            self._finish()
            return []
        return self._tell(at)

    def cancel(self, why: str) -> None:
        """End without a result, once."""
        self._end(None, why)

    def _keep(self, at: int, samples: Samples) -> None:
        """`at`: place after the newest of `samples`; only what was asked for is kept."""
        count = min(len(samples), at)
        start = at - count
        own = samples[len(samples) - count :, self._channels][: max(self._length - start, 0)]
        self._samples[start : start + len(own)] = own

    def _finish(self) -> None:
        self._end(Session(self._rate_hz, self._samples, self._prompts), "")

    def _end(self, session: Session | None, why: str) -> None:
        if not self.over:
            self.over, self.why = True, why
            self._ended(session, why)

    def _tell(self, at: int) -> list[Told]:
        """The newest change of prompts that has come by `at`; what a late tick jumps over is not told."""
        edges = [0, *(place for prompt in self._prompts for place in (prompt.shown, prompt.hidden))]
        stage = int(np.searchsorted(edges, at, side="right")) - 1
        if stage == self._stage:
            return []
        self._stage = stage
        if stage % 2 == 0:
            self.prompted = REST
            return [Told(REST, 0, self.plan.repetitions, self.plan.rest_s)]
        prompt = self._prompts[stage // 2]
        self.prompted = prompt.label
        return [Told(prompt.label, prompt.repetition + 1, self.plan.repetitions, self.plan.hold_s)]
