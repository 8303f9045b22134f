"""Trials of a session: begun, marked and ended by an experimenter, told in every frame."""

from bentod.control.journal import Journal
from bentod.errors import Refused
from bentod.frames import Trial, Value


class Trials:
    """At most one trial runs at a time; their numbers count from 1."""

    def __init__(self, journal: Journal) -> None:
        self.running: Trial | None = None
        self._journal = journal
        self._count = 0

    def start(self, name: str, condition: str) -> Trial:
        """Begin a trial.

        Raises:
            Refused: one is running.
        """
        if self.running:
            raise Refused(f"trial {self.running.number} ({self.running.name}) is running: stop it first")
        self._count += 1
        self.running = Trial(self._count, name, condition, self._journal.now)
        self._note(self.running, "started")
        return self.running

    def stop(self) -> Trial:
        """End the trial that is running.

        Raises:
            Refused: none is.
        """
        ended = self._current()
        self.running = None
        self._note(ended, "stopped")
        return ended

    def mark(self, mark: str) -> Trial:
        """Note something that happened in the trial, e.g. "circuit" or "contact".

        Raises:
            Refused: no trial is running.
        """
        trial = self._current()
        self._note(trial, f"marked: {mark}", mark)
        return trial

    def note(self, mark: str, who: str) -> Trial | None:
        """Note something that happened, in the trial if one runs, else for itself; returns that trial."""
        if self.running:
            return self.mark(mark)
        self._journal.note("mark", f"{who} marked: {mark}", {"mark": mark})
        return None

    def _current(self) -> Trial:
        if self.running is None:
            raise Refused("no trial is running")
        return self.running

    def _note(self, trial: Trial, what: str, mark: str = "") -> None:
        condition = f", {trial.condition}" if trial.condition else ""
        data: dict[str, Value] = {
            "number": trial.number,
            "name": trial.name,
            "condition": trial.condition,
            "mark": mark,
        }
        self._journal.note("trial", f"trial {trial.number} ({trial.name}{condition}) {what}", data)
