"""What does not work is logged once, and not again until it has worked in between."""

import logging


class Complaints:
    """About one matter."""

    def __init__(self, log: logging.Logger, about: str) -> None:
        self._log = log
        self._about = about
        self._told: set[str] = set()

    def add(self, sentence: str) -> None:
        """Something does not work."""
        if sentence not in self._told:
            self._told.add(sentence)
            self._log.warning("%s: %s", self._about, sentence)

    def settled(self) -> None:
        """It works."""
        if self._told:
            self._log.info("%s are heard", self._about)
        self._told.clear()
