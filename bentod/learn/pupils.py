"""The learners of a unit behind one interface: a group that shares its trace, or some that stand alone."""

from collections.abc import Mapping, Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from bentod.contracts import Arrival, Learner
from bentod.learn.encoder import Encoder
from bentod.learn.group import Group
from bentod.learn.lazy_memory import PER_GVF


class Pupils(Protocol):
    """Learners of several questions with the same γ and λ over the same representation."""

    @property
    def delta(self) -> NDArray[np.float64]:
        """δ of the last step, shape (questions,); NaN where nothing was learned."""
        ...

    @property
    def resets(self) -> NDArray[np.int64]:
        """How often each had to begin anew, shape (questions,)."""
        ...

    def step(
        self,
        encoder: Encoder,
        rewards: NDArray[np.float64],
        gamma: float,
        lam: float,
        rho: NDArray[np.float64] | None,
    ) -> NDArray[np.float64]:
        """Learn from having arrived where `encoder` looks, unless it is the first step; then predict.

        `rewards`: R_{t+1} of each question; `rho`: ρ_t of each, None for 1.
        """
        ...

    def weights(self) -> NDArray[np.float64]:
        """Weights of each, shape (features, questions)."""
        ...

    def cut(self) -> None:
        """Forget the step before, not what was learned."""
        ...

    def reset(self, columns: Sequence[int]) -> None:
        """Let some begin anew, which `resets` does not count."""
        ...

    def go_on(self, other: "Pupils", mine: Sequence[int], theirs: Sequence[int]) -> None:
        """Be where `other` is, to the last bit, and use it up: `mine` as its `theirs`. The rest begin.

        Raises:
            ValueError: those learn otherwise.
        """
        ...

    def own(self) -> frozenset[str]:
        """The entries of `memory` whose last axis is the questions."""
        ...

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """Copies of all that they have learned and remember."""
        ...

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """Become what `memory` told. Raises ValueError: it is not that of such learners."""
        ...


class Together:
    """Many questions over binary features, with one trace."""

    def __init__(self, group: Group) -> None:
        self.group = group

    @property
    def delta(self) -> NDArray[np.float64]:
        """As in `Pupils`."""
        return self.group.delta

    @property
    def resets(self) -> NDArray[np.int64]:
        """As in `Pupils`."""
        return self.group.resets

    def step(
        self,
        encoder: Encoder,
        rewards: NDArray[np.float64],
        gamma: float,
        lam: float,
        rho: NDArray[np.float64] | None,
    ) -> NDArray[np.float64]:
        """As in `Pupils`; on policy."""
        return self.group.step(encoder.features, rewards, gamma, lam)

    def weights(self) -> NDArray[np.float64]:
        """As in `Pupils`."""
        return self.group.weights_now()

    def cut(self) -> None:
        """As in `Pupils`."""
        self.group.cut()

    def reset(self, columns: Sequence[int]) -> None:
        """As in `Pupils`."""
        self.group.reset(columns)

    def go_on(self, other: Pupils, mine: Sequence[int], theirs: Sequence[int]) -> None:
        """As in `Pupils`."""
        if not isinstance(other, Together):
            raise ValueError("Learners that stood alone cannot be gone on with by a group.")
        self.group.go_on(other.group, mine, theirs)

    def own(self) -> frozenset[str]:
        """As in `Pupils`."""
        return PER_GVF

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """As in `Pupils`."""
        return self.group.memory()

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """As in `Pupils`."""
        self.group.recall(memory)


class Alone:
    """One learner a question, with weights and traces of its own."""

    def __init__(self, learners: Sequence[Learner]) -> None:
        self._learners = list(learners)
        self._first = [learner.memory() for learner in self._learners]
        self.delta = np.full(len(self._learners), np.nan)

    @property
    def resets(self) -> NDArray[np.int64]:
        """As in `Pupils`."""
        return np.array([learner.resets for learner in self._learners], dtype=np.int64)

    def step(
        self,
        encoder: Encoder,
        rewards: NDArray[np.float64],
        gamma: float,
        lam: float,
        rho: NDArray[np.float64] | None,
    ) -> NDArray[np.float64]:
        """As in `Pupils`."""
        ratios = np.ones(len(self._learners)) if rho is None else rho
        values = np.empty(len(self._learners))
        for place, learner in enumerate(self._learners):
            arrival = Arrival(float(rewards[place]), gamma, lam, float(ratios[place]))
            values[place] = learner.step(encoder.dense, arrival)
            self.delta[place] = learner.delta
        return values

    def weights(self) -> NDArray[np.float64]:
        """As in `Pupils`."""
        return np.stack([learner.memory()["weights"] for learner in self._learners], axis=1)

    def cut(self) -> None:
        """As in `Pupils`."""
        for learner in self._learners:
            learner.cut()

    def reset(self, columns: Sequence[int]) -> None:
        """As in `Pupils`."""
        for column in columns:
            self._learners[column].recall(self._first[column])

    def go_on(self, other: Pupils, mine: Sequence[int], theirs: Sequence[int]) -> None:
        """As in `Pupils`."""
        if not isinstance(other, Alone):
            raise ValueError("A group cannot be gone on with by learners that stand alone.")
        for place, their in zip(mine, theirs, strict=True):
            self._learners[place] = other._learners[their]

    def own(self) -> frozenset[str]:
        """As in `Pupils`: the arrays of all learners are stacked, so this is all of them."""
        return frozenset(self._first[0])

    def memory(self) -> dict[str, NDArray[np.float64]]:
        """As in `Pupils`."""
        told = [learner.memory() for learner in self._learners]
        return {name: np.stack([memory[name] for memory in told], axis=-1) for name in told[0]}

    def recall(self, memory: Mapping[str, NDArray[np.float64]]) -> None:
        """As in `Pupils`."""
        for place, learner in enumerate(self._learners):
            learner.recall({name: array[..., place] for name, array in memory.items()})
