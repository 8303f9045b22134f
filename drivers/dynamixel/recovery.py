"""Getting a servo out of what it complains of, as far as its firmware can; a joint is limp afterwards.

Firmware 1 takes Torque Limit as 0 while it is shut down, and works again once that is written, but only
"once error conditions are resolved" (https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#torque-limit).
Firmware 2 knows only the reboot (https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#shutdown), after which
its RAM is as after power-on; what the driver wants there is written whenever torque is switched on.
"""

from collections.abc import Sequence

from bentod.contracts import Clock
from bentod.errors import BusError
from drivers.dynamixel.options import Options
from drivers.dynamixel.servo import Servo
from drivers.dynamixel.torque import ALARMS, switch_off, watch
from drivers.dynamixel.units import goal_bytes

LIGHT = 0.4
"""Share of the greatest load: more of it for 10 s makes a servo shut down (manual of brachIOplexus)."""

GOING_DOWN = 0.05
"""s from the confirmation of a reboot until the servo hears nothing any more, assumed."""

BOOT = 1.0
"""s that a reboot may take, assumed."""


class Recovery:
    """Clears the errors of servos on one bus. Nobody waits for a reboot: each call looks if it is over."""

    def __init__(self, options: Options, clock: Clock) -> None:
        self._options = options
        self._clock = clock
        self._booting: dict[int, float] = {}  # monotonic s when it was told to, by id
        self._needs: dict[int, str] = {}  # by id of servos that are done, while others are not

    async def clear(self, servos: Sequence[Servo]) -> tuple[str, ...] | None:
        """Do what can be done; returns a sentence about each servo that needs something else.

        None while some are rebooting: then call again, soon.
        """
        if not self._booting:
            self._needs.clear()
        for servo in servos:
            if servo.id in self._booting:
                await self._look_for(servo)
            elif servo.id not in self._needs:
                self._needs[servo.id] = await self._begin(servo)
        if not self._booting.keys().isdisjoint(servo.id for servo in servos):
            return None
        self._booting.clear()
        return tuple(dict.fromkeys(need for need in self._needs.values() if need))

    async def _begin(self, servo: Servo) -> str:
        try:
            if servo.model.layout.protocol == 1:
                return await self._restore(servo)
            await servo.read_window()
            if servo.condition.alert:
                await servo.reboot()
                self._booting[servo.id] = self._clock.now()
            elif servo.condition.tripped:
                await self._go_on(servo)
        except BusError as error:
            return str(error)
        return ""

    async def _restore(self, servo: Servo) -> str:
        """Give firmware 1 its torque limit back, unless what made it shut down is still there."""
        found = await servo.read_window()
        if not ALARMS.intersection(found.errors):
            return _remaining(servo, "check its supply")
        hottest = await servo.get("Temperature Limit")
        if found.temperature >= hottest:
            return (
                f"{servo} is at {found.temperature:.0f} degrees Celsius, its limit is {hottest}; "
                "let it cool, and clear the fault again."
            )
        if abs(found.load) > LIGHT:
            return f"{servo} still carries {abs(found.load):.0%} of its greatest load; take that off."
        await switch_off(servo)
        await servo.put("Torque Limit", await servo.get("Max Torque"))
        await servo.read_window()
        return _remaining(servo, "it needs a power cycle")

    async def _go_on(self, servo: Servo) -> None:
        """End an error of the watchdog; a joint that has torque stays where it is."""
        await watch(servo, 0.0)
        if servo.torque:
            data = goal_bytes(servo.model, servo.motion.pin(servo.condition.last.position))
            await servo.put_bytes(servo.model.layout.goal[0], data)
            await watch(servo, self._options.dead_man_s or 0.0)

    async def _look_for(self, servo: Servo) -> None:
        """See whether a servo is back from its reboot, and what it is left with."""
        took = self._clock.now() - self._booting[servo.id]
        if took < GOING_DOWN:
            return
        if await servo.glimpse():
            self._needs[servo.id] = await self._end(servo)
        elif took > BOOT:
            self._needs[servo.id] = f"{servo} has not come back from its reboot; it needs a power cycle."
        else:
            return
        del self._booting[servo.id]

    async def _end(self, servo: Servo) -> str:
        try:
            servo.torque = await servo.get("Torque Enable") != 0
            servo.in_doubt = False
            await servo.read_window()
            servo.condition.note_hardware(await servo.get("Hardware Error Status"))
            servo.condition.note_watchdog(await servo.get("BUS Watchdog"))
        except BusError as error:
            return str(error)
        return _remaining(servo, "it needs a power cycle, or a repair")


def _remaining(servo: Servo, advice: str) -> str:
    errors = servo.condition.errors
    return f"{servo} still reports {', '.join(errors)}; {advice}." if errors else ""
