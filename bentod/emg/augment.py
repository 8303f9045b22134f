"""Training windows as if the muscles were also busy with something else, such as holding a load.

Thesis 3.6: "simulated signals [...] by modifying the user generated signals, which could then be included in
the training set". Nothing is known of what will be held: every channel is given a strength at random.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bentod.emg.recognition import REST, Table, Windows
from bentod.errors import ConfigError

COPIES = (0, 20)
"""Bounds of how many times more windows there may be."""

STRENGTH = (0.0, 10.0)
"""Bounds of the greatest tonic contraction, in contractions of the loudest channel."""


@dataclass(frozen=True, slots=True)
class Tonic:
    """How much is added. The defaults were chosen on simulated people: `bentod study patterns`."""

    copies: int = 4  # of every window; 0: none
    strength: float = 2.0  # times the root mean square of the loudest channel while movements are made

    def __post_init__(self) -> None:
        bounds = (("copies", self.copies, COPIES), ("strength", self.strength, STRENGTH))
        for name, value, (low, high) in bounds:
            if not low <= value <= high:
                raise ConfigError(
                    f"tonic.{name} is {value:g}; it must be from {low:g} to {high:g}", f"tonic.{name}"
                )


def with_tonic(
    windows: Windows, labels: Sequence[str], tonic: Tonic, seed: int
) -> tuple[Windows, tuple[str, ...]]:
    """The windows, and `tonic.copies` of each with a tonic contraction added, and all their labels.

    What is added to a channel is a window of the same channel while some movement was made, any of them,
    so that it has a muscle's spectrum; its strength is u·v_c·`strength`, with u drawn for the window and
    v_c for the channel, both even from 0 to 1. The contraction of another moment is independent of that of
    this one, so powers add up.

    Raises:
        ConfigError: all windows are of rest: then no muscle's signal is known.
    """
    if not tonic.copies:
        return windows, tuple(labels)
    active = windows[[label != REST for label in labels]]
    if not len(active):
        raise ConfigError("tonic contractions are made of windows with movements; there are none", "tonic")
    random = np.random.default_rng([seed, 8])
    count, channels, _ = windows.shape
    loudest = tonic.strength * float(_level(active).mean(axis=0).max())
    made = [np.asarray(windows)]
    for _ in range(tonic.copies):
        taken = random.integers(0, len(active), (count, channels))
        added = active[taken, np.arange(channels)]
        level = np.maximum(_level(added), np.finfo(np.float64).tiny)
        wanted = loudest * random.random((count, 1)) * random.random((count, channels))
        made.append(windows + added * (wanted / level)[..., np.newaxis])
    return np.concatenate(made), tuple(labels) * (tonic.copies + 1)


def _level(windows: Windows) -> Table:
    """Root mean square, shape (windows, channels)."""
    return np.asarray(np.sqrt(np.mean(windows**2, axis=-1)))
