"""Whom to ask in a round of reading, so that a silent servo silences nobody else.

In a bulk or sync read each servo waits for the packet of the one before it, so one that is silent breaks the
chain for all behind it.
"""

from collections.abc import Collection, Sequence

LONGEST_PAUSE = 0.25
"""s: a servo that stays silent is asked again at least this often."""


class Roll:
    """Keeps the silent apart: they are asked last, one at a time, and ever more rarely."""

    def __init__(self, ids: Sequence[int], now: float, chained: bool = True) -> None:
        """`chained`: several are asked at once; otherwise one after another."""
        self.chained = chained
        self._ids = tuple(ids)
        self._heard = dict.fromkeys(ids, now)
        self._asked = dict.fromkeys(ids, now)
        self._silent: set[int] = set()
        self._left: list[int] = []
        self._stragglers: list[int] = []

    def begin(self, now: float) -> None:
        """A new round: whoever is not silent, first who was left out last time; then silent ones in turn."""
        talking = [id_ for id_ in self._ids if id_ not in self._silent]
        left = [id_ for id_ in self._left if id_ not in self._silent]
        self._left = left + [id_ for id_ in talking if id_ not in left] if left else talking
        due = [id_ for id_ in self._ids if id_ in self._silent and self._due(id_, now)]
        self._stragglers = sorted(due, key=self._asked.__getitem__)

    def chain(self) -> list[int]:
        """Whom to ask next of those that are not silent. Empty: done."""
        return self._left[:] if self.chained else self._left[:1]

    def straggler(self) -> list[int]:
        """The next one of the silent that has been left alone for long enough. Empty: done."""
        return self._stragglers[:1]

    def note(self, chain: Sequence[int], answered: Collection[int], now: float) -> None:
        """Of `chain`, `answered` were heard. Who stands behind the last of them is silent.

        Who is missing before that did reply, or the chain would have ended there: its reply was damaged,
        and it is asked once more.
        """
        reached = max((i for i, id_ in enumerate(chain) if id_ in answered), default=-1)
        for id_ in answered:
            self._heard[id_] = now
        self._silent.difference_update(answered)
        done = set(answered)
        if reached + 1 < len(chain):
            done.add(chain[reached + 1])
            self._silent.add(chain[reached + 1])
            self._asked[chain[reached + 1]] = now
        self._left = [id_ for id_ in self._left if id_ not in done]
        self._stragglers = [id_ for id_ in self._stragglers if id_ not in done]

    def _due(self, id_: int, now: float) -> bool:
        pause = min((self._asked[id_] - self._heard[id_]) / 4, LONGEST_PAUSE)
        return now - self._asked[id_] >= pause
