"""Brings the arm to the mode that it is to start in, unless somebody else decides meanwhile."""

import logging
from collections.abc import Callable

from bentod.contracts import Clock
from bentod.control.arming import UNREAD
from bentod.desk import Desk
from bentod.errors import BentodError, Refused
from bentod.inbox import Inbox

_log = logging.getLogger(__name__)

FALL = 5.0
"""s that joints have to come to rest before the arm is armed at the start: a limp arm hangs still by then."""


class Start:
    """Arms and releases the arm in steps, between which anybody may stop it: then that holds."""

    def __init__(self, inbox: Inbox, clock: Clock) -> None:
        self._inbox = inbox
        self._clock = clock
        self._interventions = 0

    async def run(self, wanted: str) -> None:
        """Bring the arm to `wanted`: "limp", "hold" or "active". What stands in the way is logged."""
        try:
            if wanted in ("hold", "active"):
                await self._insist(_arm, "armed")
            if wanted == "active":
                await self._insist(_release, "released")
            answer = await self._inbox.ask(lambda desk: desk.modes.arm)
        except BentodError as error:
            _log.warning("the arm did not start as the config asks: %s", error)
        else:
            _log.info("the arm is %s", answer.result.value)

    async def _insist(self, step: Callable[[Desk], str], what: str) -> None:
        """Take a step as soon as nothing stands in its way.

        Raises:
            Refused: something still does after `FALL`, a fault came, or somebody intervened.
        """
        deadline = self._clock.now() + FALL
        told = False
        while reason := (await self._inbox.ask(lambda desk: self._step(desk, step))).result:
            if self._clock.now() >= deadline:
                raise Refused(f"not {what}: {reason}")
            if reason != UNREAD and not told:
                _log.info("waiting up to %g s before the arm is %s: %s", FALL, what, reason)
                told = True

    def _step(self, desk: Desk, step: Callable[[Desk], str]) -> str:
        if desk.interventions != self._interventions:
            raise Refused("it was stopped, paused or switched meanwhile")
        reason = desk.recency.doubt() or step(desk)
        self._interventions = desk.interventions
        return reason


def _arm(desk: Desk) -> str:
    """Ask for torque on every joint, or say why not."""
    everyone = desk.select(None)
    reason = desk.unfit(everyone)
    if not reason:
        desk.torque(everyone, True)
    return reason


def _release(desk: Desk) -> str:
    desk.pause(desk.select(None), False)
    return ""
