"""Conditioned samples in, decisions out: the same ones from a stream and from its recording."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bentod.emg.classify.deciding import Decider, Deciding
from bentod.emg.classify.loudness import loudness
from bentod.emg.classify.model import Model
from bentod.emg.recognition import Decision, Follows, Fuse, Windows
from bentod.emg.segmenting import Segmenter

MISSING = "EMG samples of this window are missing."


class Pipeline:
    """Windows, features, classifier and decisions in a row. It knows sample indices and no time."""

    def __init__(self, model: Model, deciding: Deciding | None = None, fuse: Fuse | None = None) -> None:
        """`fuse`: weighs predictions in. Raises ConfigError: the model's segmenting makes no windows."""
        self.model = model
        self._fuse = fuse
        self._segmenter = Segmenter(model.setting.segmenting, model.setting.channels)
        self._decider = Decider(model.labels, model.ranges, deciding)

    def step(self, first_index: int, samples: NDArray[np.floating]) -> list[Decision]:
        """Decisions about the windows that these samples completed, in order.

        `samples`: conditioned, V, shape (n, channels), the first with index `first_index`; NaN where missing.
        A window with missing samples, or a feature that is not finite, decides for rest and says why.

        Raises:
            ValueError: the samples do not follow what has come, or have another number of channels.
        """
        cut = self._segmenter.feed(first_index, samples)
        if cut.lost:
            self._decider.forget()
        if cut.lost or not cut.complete.all():
            self._interrupt()
        if not len(cut.windows):
            return []
        whole = cut.windows[cut.complete]
        answers = iter(self._answers(whole) if len(whole) else [])
        segmenting = self.model.setting.segmenting
        ends = (cut.first + np.arange(len(cut.windows))) * segmenting.step + segmenting.length - 1
        return [
            self._decide(int(index), next(answers) if complete else MISSING)
            for index, complete in zip(ends, cut.complete, strict=True)
        ]

    def forget(self) -> None:
        """Nothing that was voted for or held counts any more; samples that came before still do."""
        self._decider.forget()

    def _answers(self, windows: Windows) -> list[tuple[list[float], float] | str]:
        """Of each window its probabilities and loudness, or why there are none."""
        table = self.model.features.of(windows)
        finite = np.isfinite(table)
        fine = np.asarray(finite.all(axis=1))
        shares = iter(self.model.classifier.probabilities(table[fine]).tolist())
        return [
            (next(shares), loud) if good else self._not_finite(known)
            for good, known, loud in zip(fine.tolist(), finite, loudness(windows).tolist(), strict=True)
        ]

    def _not_finite(self, known: NDArray[np.bool_]) -> str:
        return f"The EMG feature {self.model.features.names[int(np.argmin(known))]} is not a finite number."

    def _decide(self, index: int, answer: tuple[list[float], float] | str) -> Decision:
        if isinstance(answer, str):
            return self._decider.refuse(index, answer)
        if self._fuse is None:
            return self._decider.decide(index, *answer)
        alone, loud = answer
        fused = self._fuse(self.model.labels, alone)
        # A prediction that agrees with the muscles takes nothing from how sure they are.
        weighed = [fused.likelihoods[label] for label in self.model.labels] if fused.changed else alone
        decision = self._decider.decide(index, weighed, loud)
        told = dict(zip(self.model.labels, alone, strict=True))
        return replace(decision, probabilities=told, fused=fused)

    def _interrupt(self) -> None:
        if isinstance(self.model.classifier, Follows):
            self.model.classifier.interrupt()
