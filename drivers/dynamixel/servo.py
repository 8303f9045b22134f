"""One joint's servo: registers by name, asked for and told until that is confirmed."""

from collections.abc import Awaitable, Callable

from bentod.errors import BusError
from bentod.frames import Command, JointSpec, JointState
from drivers.dynamixel.bus import Bus, Reply
from drivers.dynamixel.codec import Version
from drivers.dynamixel.condition import Condition
from drivers.dynamixel.firmware1 import REFUSED
from drivers.dynamixel.firmware2 import ALERT, RESULTS
from drivers.dynamixel.motion import Goal, JointMotion
from drivers.dynamixel.options import Hardware, Options, tuning
from drivers.dynamixel.registers import Register, to_raw, with_sign
from drivers.dynamixel.units import Reading, error_names


class Servo:
    """A servo, asked and told by name of its registers."""

    def __init__(self, bus: Bus, spec: JointSpec, hardware: Hardware, options: Options) -> None:
        self.spec = spec
        self.hardware = hardware
        self.id = hardware.id
        self.model = hardware.kind
        self.motion = JointMotion(spec, tuning(options, hardware))
        self.condition = Condition(self.model, str(self), options.lost_after_s)
        self.torque = False
        """As last confirmed."""
        self.in_doubt = True
        """It was silent, or reset, or an order was not confirmed: `torque` must be read again."""
        self._bus = bus
        self._protocol = self.model.layout.protocol
        self._attempts = options.attempts

    @property
    def goal_address(self) -> tuple[Version, int]:
        """How its goals are written: the protocol, and the first address."""
        return self._protocol, self.register(self.model.layout.goal[0]).address

    def __str__(self) -> str:
        return f"Servo {self.id} ({self.spec.name})"

    def register(self, name: str) -> Register:
        """A register of this model, by the manual's name."""
        return self.model.table[name]

    def heard(self, reply: Reply) -> bool:
        """Take over a reply to the usual window; False if it cannot be believed.

        A servo that has just shut down may have switched its torque off by itself: firmware 2 does.
        """
        before = self.condition.alert or self.condition.shut_down
        believed = self.condition.heard(reply)
        if not before and (self.condition.alert or self.condition.shut_down):
            self.in_doubt = True
        return believed

    def age(self, now: float) -> float:
        """Seconds from the last reading to `now` (monotonic s)."""
        return self.condition.age(now)

    def state(self, now: float, fresh: bool) -> JointState:
        """The joint as it looks at `now` (monotonic s)."""
        return self.condition.state(now, fresh, self.motion.report)

    def goal(self, command: Command, now: float) -> Goal:
        """What to send for `command` at `now` (monotonic s)."""
        trajectory = self.condition.last.trajectory
        return self.motion.command(command, self.state(now, fresh=False), now, trajectory)

    async def ping(self) -> bool:
        """Whether the servo answers a ping."""
        return await self._persist(lambda: self._bus.ping(self._protocol, self.id)) is not None

    async def glimpse(self) -> bool:
        """Whether the servo answers a single ping."""
        return await self._bus.ping(self._protocol, self.id) is not None

    async def reboot(self) -> None:
        """Have firmware 2 start anew.

        Raises:
            BusError: not confirmed.
        """
        self.in_doubt = True
        if await self._persist(lambda: self._bus.reboot(self.id)) is None:
            raise self.error("did not confirm to reboot; check its cable and its power.")

    async def read_window(self) -> Reading:
        """A reading made now.

        Raises:
            BusError: no answer, or none that can be believed.
        """
        window = self.model.layout.windows[0]
        for _ in range(self._attempts):
            if self.heard(await self._read(window.address, window.size)):
                return self.condition.last
        raise self.error("answers with values that cannot be; check its cable.")

    async def glance(self, name: str) -> int | None:
        """The raw value of a register, asked for once; None when there was no answer."""
        register = self.register(name)
        replies = await self._bus.read(self._protocol, (self.id,), register.address, register.size)
        return to_raw(register, replies[self.id].data, register.address) if self.id in replies else None

    async def get(self, name: str) -> int:
        """The raw value of a register.

        Raises:
            BusError: no answer.
        """
        register = self.register(name)
        return to_raw(register, await self.get_bytes(name, name), register.address)

    async def get_bytes(self, first: str, last: str) -> bytes:
        """Everything from register `first` to register `last`.

        Raises:
            BusError: no answer.
        """
        start = self.register(first).address
        return (await self._read(start, self.register(last).end - start)).data

    async def get_all(self, first: str, last: str) -> dict[str, int]:
        """The values of every register from `first` to `last`, signed where the register is.

        Raises:
            BusError: no answer.
        """
        data = await self.get_bytes(first, last)
        start, end = self.register(first).address, self.register(last).end
        return {
            name: with_sign(register, to_raw(register, data, start))
            for name, register in self.model.table.items()
            if start <= register.address < end
        }

    async def other_number(self) -> int | None:
        """The model number of a servo that has this id but speaks the other protocol; None: nobody."""
        other: Version = 2 if self._protocol == 1 else 1

        async def ask() -> Reply | None:
            return (await self._bus.read(other, (self.id,), 0, 2)).get(self.id)

        reply = await self._persist(ask)
        return None if reply is None else int.from_bytes(reply.data, "little")

    async def put(self, name: str, value: int) -> None:
        """Write a raw value to a register, and have it confirmed.

        Raises:
            BusError: not confirmed, or refused.
        """
        await self.put_bytes(name, value.to_bytes(self.register(name).size, "little"))

    async def put_bytes(self, name: str, data: bytes) -> None:
        """Write `data` from a register on, and have it confirmed.

        Raises:
            BusError: not confirmed, or refused.
        """
        reply = await self._write(self.register(name).address, data)
        refusal = self._refusal(reply.error)
        if refusal:
            raise self.error(f"refused to have {name} set to {data.hex(' ')}: {refusal}.")

    def error(self, complaint: str) -> BusError:
        """An error about this servo; when the whole line is gone, that is what it says."""
        return BusError(self._bus.problem or f"{self} {complaint}")

    def _refusal(self, error: int) -> str:
        """Why an instruction was not carried out, in the manual's words; empty if it was."""
        if self._protocol == 1:
            return ", ".join(error_names(error & REFUSED))
        number = error & ~ALERT
        return RESULTS[number] if number < len(RESULTS) else f"error {number}"

    async def _read(self, address: int, size: int) -> Reply:
        async def ask() -> Reply | None:
            return (await self._bus.read(self._protocol, (self.id,), address, size)).get(self.id)

        reply = await self._persist(ask)
        if reply is None:
            raise self.error(
                f"does not answer when asked for address {address}; check its cable, and that its "
                "Status Return Level is not 0."
            )
        return reply

    async def _write(self, address: int, data: bytes) -> Reply:
        reply = await self._persist(lambda: self._bus.write(self._protocol, self.id, address, data))
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
