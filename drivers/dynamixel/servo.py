"""One joint's servo: what is known of it, and questions that are repeated until they are answered."""

from collections.abc import Awaitable, Callable

from bentod.errors import BusError
from bentod.frames import Command, Freshness, JointSpec, JointState
from drivers.dynamixel.bus import Bus, Reply
from drivers.dynamixel.motion import Goal, JointMotion
from drivers.dynamixel.options import Hardware, Options, tuning
from drivers.dynamixel.tables import MODELS, REFUSED, Register
from drivers.dynamixel.units import WINDOW, WINDOW_SIZE, Reading, error_names, reading, to_raw


class Servo:
    """A servo, asked and told by name of its registers."""

    def __init__(self, bus: Bus, spec: JointSpec, hardware: Hardware, options: Options) -> None:
        self.spec = spec
        self.hardware = hardware
        self.id = hardware.id
        self.motion = JointMotion(spec, tuning(options, hardware))
        self.model = MODELS[hardware.model]
        self.torque = False
        """As last confirmed."""
        self.in_doubt = True
        """It was silent, or an order was not confirmed: `torque` must be read again."""
        self._bus = bus
        self._attempts = options.attempts
        self._lost_after = options.lost_after_s
        self._reading = Reading(0.0, 0.0, 0.0, 0.0, 0.0, ())
        self._read_at = float("-inf")

    def __str__(self) -> str:
        return f"Servo {self.id} ({self.spec.name})"

    def register(self, name: str) -> Register:
        """A register of this model, by the manual's name."""
        return self.model.table[name]

    def heard(self, reply: Reply) -> None:
        """Take over a reply to the reading of the window."""
        self._reading = reading(reply.error, reply.data)
        self._read_at = reply.time

    def age(self, now: float) -> float:
        """Seconds from the last reading to `now` (monotonic s)."""
        return now - self._read_at

    def state(self, now: float, fresh: bool) -> JointState:
        """The last reading as it looks at `now` (monotonic s)."""
        age = self.age(now)
        known = self._reading
        silent = Freshness.LOST if age > self._lost_after else Freshness.STALE
        return JointState(
            position=known.position,
            velocity=known.velocity,
            load=known.load,
            voltage=known.voltage,
            temperature=known.temperature,
            age=age,
            freshness=Freshness.FRESH if fresh else silent,
            errors=known.errors,
        )

    def goal(self, command: Command, now: float) -> Goal:
        """What to send for `command` at `now` (monotonic s)."""
        return self.motion.command(command, self.state(now, fresh=False))

    async def ping(self) -> None:
        """Find the servo on the bus.

        Raises:
            BusError: nobody answers.
        """
        if await self._persist(lambda: self._bus.ping(self.id)) is None:
            raise self.error("does not answer a ping; check its power, its cable, its id and the baud rate.")

    async def read_window(self) -> Reading:
        """A reading made now.

        Raises:
            BusError: no answer.
        """
        self.heard(await self._read(WINDOW.start, WINDOW_SIZE))
        return self._reading

    async def get(self, name: str) -> int:
        """The raw value of a register.

        Raises:
            BusError: no answer.
        """
        register = self.register(name)
        reply = await self._read(register.address, register.size)
        return to_raw(register, reply.data, register.address)

    async def get_bytes(self, first: str, last: str) -> bytes:
        """Everything from register `first` to register `last`.

        Raises:
            BusError: no answer.
        """
        start = self.register(first).address
        return (await self._read(start, self.register(last).end - start)).data

    async def put(self, name: str, value: int) -> None:
        """Write a raw value to a register, and have it confirmed.

        Raises:
            BusError: not confirmed, or refused.
        """
        register = self.register(name)
        await self.put_bytes(name, value.to_bytes(register.size, "little"))

    async def put_bytes(self, name: str, data: bytes) -> None:
        """Write `data` from a register on, and have it confirmed.

        Raises:
            BusError: not confirmed, or refused.
        """
        reply = await self._write(self.register(name).address, data)
        if reply.error & REFUSED:
            names = ", ".join(error_names(reply.error & REFUSED))
            raise self.error(f"refused to have {name} set to {data.hex(' ')}: {names}.")

    def error(self, complaint: str) -> BusError:
        """An error about this servo; when the whole line is gone, that is what it says."""
        return BusError(self._bus.problem or f"{self} {complaint}")

    async def _read(self, address: int, size: int) -> Reply:
        async def ask() -> Reply | None:
            return (await self._bus.read((self.id,), address, size)).get(self.id)

        reply = await self._persist(ask)
        if reply is None:
            raise self.error(
                f"does not answer when asked for address {address}; check its cable, and that its "
                "Status Return Level is not 0."
            )
        return reply

    async def _write(self, address: int, data: bytes) -> Reply:
        reply = await self._persist(lambda: self._bus.write(self.id, address, data))
        if reply is None:
            raise self.error(f"did not confirm a write to address {address}; check its cable and its power.")
        return reply

    async def _persist(self, ask: Callable[[], Awaitable[Reply | None]]) -> Reply | None:
        """Ask until there is a reply, at most `attempts` times, and not on a line that is gone."""
        for attempt in range(self._attempts):
            if attempt > 0:
                await self._bus.settle()
            reply = await ask()
            if reply is not None or self._bus.problem:
                return reply
        return None
