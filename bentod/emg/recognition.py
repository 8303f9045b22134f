"""What the parts of pattern recognition agree on: windows, features, classifiers, decisions.

Sample index is the clock of everything. Window k has the samples from k·step to k·step + length, whatever
blocks they came in and however late; so what is decided on-line is what is decided off-line, bit for bit.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Protocol, TypeAlias, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from bentod.frames import Value

Windows: TypeAlias = NDArray[np.float64]
"""V, shape (windows, channels, samples): a look at conditioned samples, not a copy; nobody writes to it."""

Table: TypeAlias = NDArray[np.float64]
"""One row a window, shape (windows, columns)."""

REST = "rest"
"""The class of muscles that do nothing; it moves nothing."""


@dataclass(frozen=True, slots=True)
class Segmenting:
    """How a signal is cut into windows (thesis 3.3.1: 150 ms by 50 ms)."""

    length: int  # samples, at least 2
    step: int  # samples from one window to the next, at least 1


class Features(Protocol):
    """A list of features with everything that makes its numbers what they are."""

    names: tuple[str, ...]
    """Of the columns, e.g. "mav[3]" of channel 3."""

    def of(self, windows: Windows) -> Table:
        """One row a window, shape (windows, len(names)), finite; a row depends on its own window only.

        Bit for bit the same for a window alone and among others.
        """
        ...

    def fit(self, windows: Windows) -> "Features":
        """The same features with what they take from training data, such as edges of a histogram."""
        ...

    def spec(self) -> Mapping[str, Value]:
        """Names, variants, thresholds, units, order, channels, rate and what `fit` found: all of it."""
        ...


class Classifier(Protocol):
    """Tells classes apart. One-window answers take microseconds, and start no thread."""

    labels: tuple[str, ...]

    def probabilities(self, table: Table) -> Table:
        """Of each class, shape (windows, len(labels)); each row adds up to 1."""
        ...

    def arrays(self) -> Mapping[str, NDArray[np.float64]]:
        """All that it knows, as it is kept in a model file."""
        ...


@runtime_checkable
class Follows(Protocol):
    """What a classifier offers besides that learns from what it is asked."""

    def interrupt(self) -> None:
        """Windows are missing: those before have nothing to do with those that come."""
        ...


class Train(Protocol):
    """How a classifier is trained."""

    def __call__(
        self, table: Table, labels: Sequence[str], options: Mapping[str, float], seed: int
    ) -> Classifier:
        """From rows and their labels. Raises ConfigError: an option or too few classes or rows."""
        ...


@dataclass(frozen=True, slots=True)
class Fused:
    """What a decision owes to a prediction (thesis 6.2)."""

    weight: float  # β C of (6.6), 0..1; 0: the prediction counted nothing
    likelihoods: Mapping[str, float]  # by label, the prediction included; they add up to 1
    unaided: str  # the most probable label without it

    @property
    def likely(self) -> str:
        """The most probable label with it."""
        return max(self.likelihoods, key=self.likelihoods.__getitem__)

    @property
    def changed(self) -> bool:
        """Whether the prediction made another movement the most probable."""
        return self.likely not in (self.unaided, REST)


Fuse: TypeAlias = Callable[[Sequence[str], Sequence[float]], Fused]
"""Labels and the classifier's probabilities of a window, weighed with what is predicted of them."""


@dataclass(frozen=True, slots=True)
class Decision:
    """What one window says."""

    index: int  # of the sample that completed the window
    label: str  # what is decided after rejection and votes; `REST` where nothing is to move
    speed: float  # 0..1, proportional to the contraction within what the class had in training
    probabilities: Mapping[str, float]  # by label, as the classifier gives them
    likely: str  # the most probable label, rejected or not
    rejected: bool  # the classifier was not sure enough of it
    reason: str = ""  # why there is no decision, e.g. samples are missing; empty otherwise
    fused: Fused | None = None  # None: nothing is predicted here; `likely` is then the classifier's own

    @property
    def at_rest(self) -> bool:
        """Whether the muscles were seen at rest; to ask for nothing, such as when not sure, is not enough."""
        return self.label == self.likely == REST and not (self.rejected or self.reason)
