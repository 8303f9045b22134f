"""`advice("adviser", "question")` in an expression: what an adviser answers, as one more thing perceived."""

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

from bentod.errors import ConfigError
from bentod.learn.expression_nodes import Advice
from bentod.learn.signals import Named

DIGITS = 12
"""Of a snapshot's digest, which an expression that is written out shows: other weights, other advice."""


@runtime_checkable
class Advising(Protocol):
    """Signals that advice comes with."""

    def advice(self, adviser: str, question: str) -> tuple[int, str]:
        """Where in the vector an answer stands from now on, and the digest of what it is from.

        Raises:
            ConfigError: there is no such adviser, or it cannot answer that.
        """
        ...


def advice(signals: Named, words: Sequence[object]) -> Advice:
    """What the arguments of `advice` stand for. Raises ConfigError: nobody can say that."""
    adviser, question, *digest = words
    if not all(isinstance(word, str) for word in words):
        raise ConfigError('needs names in quotes: advice("simulated", "elbow.position@20")')
    if not isinstance(signals, Advising):
        raise ConfigError("an adviser has no advisers itself")
    place, known = signals.advice(str(adviser), str(question))
    if digest and not known.startswith(str(digest[0])):
        raise ConfigError(f"the adviser '{adviser}' is of the snapshot {known[:DIGITS]}, not {digest[0]}")
    return Advice(place, f"{adviser}/{question}/{known[:DIGITS]}")
