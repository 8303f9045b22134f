"""Whether what was learned in use still suits the wearer better than what was known before."""

from bentod.emg.adapt.normal import Normal, Row

MEMORY = 0.25
"""Weight of the newest contraction."""

KEEP_EVERY = 20
"""Calm contractions after which the state is kept, to be gone back to."""

PROBATION = 6
"""Contractions after a change of state before it is judged."""

CLEARLY = 0.9
"""Share of the distance that an earlier state must be nearer, to be gone back to for that alone."""


class Health:
    """Keeps the trained state and one that has proved itself, and goes back to one that fits better.

    A state fits as far as contractions lie near its classes, whichever they are near to: how sure a state is
    of them says nothing, since who takes all for one class is sure. While signals drift, what was learned of
    the drift fits better than what was trained, and stays.
    """

    def __init__(self, trained: Normal, trouble: float) -> None:
        """`trouble`: share of calm contractions, 0..1, below which any state that fits better will do."""
        self.rolled_back = 0
        """How often an earlier state was gone back to."""
        self.calm = 1.0
        """Share of contractions that nobody took back and that looked like one class, 0..1."""
        self._trouble = trouble
        self._trained, self._proved = trained, trained
        self._far = {"now": 0.0, "proved": 0.0, "trained": 0.0}
        self._seen = self._good = 0

    def judge(self, before: Normal, now: Normal, seen: Row, calm: bool) -> Normal:
        """What to go on with after a contraction, of which `seen` is the mean row.

        `before`: what did not know it yet, and is measured by it; `now`: what has learned from it.
        """
        self._seen += 1
        self._good += calm
        self.calm += MEMORY * (calm - self.calm)
        for name, state in {"now": before, "proved": self._proved, "trained": self._trained}.items():
            self._far[name] += MEMORY * (float(state.distances(seen).min()) - self._far[name])
        if self._seen < PROBATION:
            return now
        clearly = 1.0 if self.calm < self._trouble else CLEARLY
        name = min(self._far, key=self._far.__getitem__)
        if self._far[name] < clearly * self._far["now"]:
            return self._back(name)
        if self._good >= KEEP_EVERY and name == "now":
            self._proved, self._good = now, 0
            self._far["proved"] = self._far["now"]
        return now

    def _back(self, name: str) -> Normal:
        self.rolled_back += 1
        self._seen = self._good = 0
        self._far["now"] = self._far[name]
        if name == "trained":
            self._proved = self._trained
            self._far["proved"] = self._far[name]
        return self._proved
