"""One joint-mode servo as a pure `step(dt)`: dead time, profile, P controller, motor, friction, sensors.

The controller law and the motor constants are from Rhoban/bam (Apache-2.0; Duclusaud et al., ICRA 2025).
Dead time: Smith & Jivraj's measurements on AX-12+. Thermal constants, the overload rule, the boot time and
the cable's resistance are assumed. Not modelled: backlash, gear compliance, jerk of the profile, filtering of
the present speed, I and D gains, an AX's compliance margin and punch, Stribeck friction, coupling between
joints, contact. No number that comes out of here was ever compared with a real servo.
"""

import random
from collections import deque
from dataclasses import dataclass, replace
from math import copysign, inf, sqrt

from sim.servo_models import ServoModel
from sim.shaft import Link, Shaft

STIFFNESS = 0.158 * 32
"""Duty per rad of error at the default P gain of 32 (bam)."""

GREATEST_DUTY = 0.9625
"""Measured with an oscilloscope (bam)."""

ROOM = 25.0
"""Degrees Celsius."""

HEATING = 6.0
"""K/W, assumed."""

COOLING = 1 / 600.0
"""1/s: a time constant of about ten minutes, assumed."""

OVERLOAD_DUTY, OVERLOAD_AFTER = 0.4, 10.0
"""The manual of brachIOplexus: a load above about 400 for about 10 s trips."""

CABLE = 0.15
"""Ω between supply and servo, assumed."""

BOOT = 0.3
"""s from power or a reboot to the first answer, assumed."""

AWAKE = 3
"""Substeps before something is due in which a servo at rest is stepped again."""


@dataclass(frozen=True, slots=True)
class Setting:
    """What the servo is told; it takes effect after the dead time."""

    goal: float = 0.0  # rad
    speed: float = 0.0  # rad/s, 0: as fast as it can
    torque_on: bool = False
    acceleration: float = 0.0  # rad/s², 0: at once
    torque_limit: float = 1.0  # share of the greatest duty
    stiffness: float = STIFFNESS  # duty per rad


@dataclass(frozen=True, slots=True)
class Reading:
    """What the servo's sensors say, in the quantisation of its model."""

    ticks: int  # position
    speed: int  # signed
    load: float  # duty, -1..1
    voltage: float  # V
    temperature: float  # degrees Celsius
    current: float  # A
    moving: bool


class Servo(Shaft):
    """A servo with what hangs on it. Positions in rad, 0 at the centre, counter-clockwise positive."""

    def __init__(
        self, model: ServoModel, link: Link, position: float = 0.0, dead_time: float = 0.017, seed: str = ""
    ) -> None:
        super().__init__(link, model.armature, model.coulomb, position)
        self.model = model
        self.time = 0.0
        self.reference, self.rate = position, 0.0
        """rad and rad/s: where its profile is, to where the P controller pulls the shaft, and how fast."""
        self.duty = 0.0
        self.current = 0.0
        self.temperature = ROOM
        self.temperature_limit = 80.0
        self.voltage_limits = (6.0, 16.0)
        self.shutdown = ""
        """The alarm that cut the torque, "overload" or "overheat"; empty when none did."""
        self.boots = 0
        """Times that it started anew: whoever keeps registers for this servo then starts afresh."""
        self.boot_time = BOOT
        self.powered = True
        self.silent = False
        self.tripped = False
        """Whether its watchdog heard nothing for too long."""
        self.glitch_rate = 0.0
        """Chance that one reading of the encoder is nonsense."""
        self.load_offset = 0.0
        self.slowness = 0.0
        """s of dead time in addition to the usual."""
        self.supply = 12.0
        self.room = ROOM
        """Degrees Celsius around it in peace."""
        self.ambient = ROOM
        self._random = random.Random(seed)
        self.dead_time = dead_time + self._random.uniform(0.0, 0.002)
        self._strain = 0.0
        self._patience = 0.0
        self._bite = inf
        self._up = 0.0
        self._queue: deque[tuple[float, Setting]] = deque()
        self._setting = Setting(position)
        self._greatest = GREATEST_DUTY
        self._torque_per_volt = model.torque_constant / model.resistance
        self._back_emf = model.torque_constant * self._torque_per_volt + model.viscous

    @property
    def answers(self) -> bool:
        """Whether it hears and replies on the bus."""
        return self.powered and not self.silent and self.time >= self._up

    def tell(self, setting: Setting) -> None:
        """Queue `setting`; settings take effect in order, each no sooner than the dead time from now."""
        due = self.time + self.dead_time + self.slowness
        if self._queue:
            due = max(due, self._queue[-1][0])
        self._queue.append((due, setting))

    def run(self, steps: int, dt: float) -> None:
        """Step `steps` times; a stretch in which nothing can move costs no more than one step."""
        while steps > 0:
            before = self.reference
            self.step(dt)
            steps -= 1
            if self.velocity == 0.0 and self.reference == before and not self.rate:
                steps -= self._rest(steps, dt)

    def step(self, dt: float) -> None:
        """Let `dt` (s, about 0.001) pass."""
        self.time += dt
        while self._queue and self._queue[0][0] <= self.time:
            self._obey(self._queue.popleft()[1])
        if self.time >= self._bite:
            self.bite()
        if self._setting.torque_on and self.powered and not self.shutdown:
            self._follow(dt)
            duty = self._setting.stiffness * (self.reference - self.position)
            if not -self._greatest <= duty <= self._greatest:
                duty = copysign(self._greatest, duty)
            self._drive(dt, duty)
        else:
            self._coast(dt)
        self._wear(dt)

    def sense(self) -> Reading:
        """Position, speed, load and the rest, as the registers would show them."""
        scale = self.model.scale
        ticks = scale.ticks(self.position)
        if self.glitch_rate and self._random.random() < self.glitch_rate:
            ticks = self._random.randrange(scale.last + 1)
        return Reading(
            ticks=min(max(ticks, 0), scale.last),
            speed=round(self.velocity / scale.speed),
            load=min(max(self.duty + self.load_offset, -1.0), 1.0),
            voltage=self.supply - CABLE * abs(self.current),
            temperature=self.temperature,
            current=self.current,
            moving=abs(self._setting.goal - self.reference) > scale.tick / 2,
        )

    def errors(self) -> tuple[str, ...]:
        """Standing complaints, in the manual's words; also what the bits of a status packet say."""
        found = []
        lowest, highest = self.voltage_limits
        if not lowest <= self.supply <= highest:
            found.append("Input Voltage Error")
        if self.shutdown == "overheat" or self.temperature > self.temperature_limit:
            found.append("Overheating Error")
        if self.shutdown == "overload":
            found.append("Overload Error")
        return tuple(found)

    def trip(self, alarm: str) -> None:
        """Cut the torque and latch `alarm`."""
        self.shutdown = alarm
        self._strain = 0.0

    def restore(self) -> None:
        """Give the torque back after an alarm, as writing Torque Limit does; refused while it is hot."""
        if self.temperature <= self.temperature_limit:
            self.shutdown = ""

    def watch(self, patience: float) -> None:
        """Stop if nothing is heard for `patience` (s; 0: never), and forget that it was so."""
        self._patience = patience
        self.tripped = False
        self.heard()

    def heard(self) -> None:
        """Someone talks to it."""
        self._bite = self.time + self._patience if self._patience and not self.tripped else inf

    def bite(self) -> None:
        """Stop where the profile is, at once: with neither Profile Velocity nor Profile Acceleration.

        Source: https://emanual.robotis.com/docs/en/dxl/x/xm430-w210/#bus-watchdog; for MX(2.0) assumed.
        """
        self.tripped = True
        self._bite = inf
        self._queue.clear()
        self.rate = 0.0
        self._obey(replace(self._setting, goal=self.reference, speed=0.0, acceleration=0.0))

    def power(self, on: bool) -> None:
        """Cut or restore the supply; it comes back limp and with its registers at their defaults."""
        if on and not self.powered:
            self.reboot()
        self.powered = on

    def reboot(self) -> None:
        """Start anew: limp, and silent for `boot_time`."""
        self.boots += 1
        self._up = self.time + self.boot_time
        self._queue.clear()
        self._setting = Setting(self.position)
        self.shutdown = ""
        self._strain = 0.0
        self.watch(0.0)

    def _obey(self, setting: Setting) -> None:
        self._setting = setting
        self._greatest = min(GREATEST_DUTY, setting.torque_limit)

    def _rest(self, steps: int, dt: float) -> int:
        """Let up to `steps` pass in which nothing moves, and return how many did."""
        if self._strain or self.temperature > self.temperature_limit - 1.0:
            return 0
        due = min(self._bite, self._queue[0][0] if self._queue else inf)
        idle = min(steps, max((due - self.time) / dt - AWAKE, 0))
        passed = int(idle)
        self.time += passed * dt
        self._wear(passed * dt)
        return passed

    def _follow(self, dt: float) -> None:
        """Move the reference towards the goal: v ≤ Moving Speed, v ≤ √(2a·distance), dv ≤ a·dt."""
        setting = self._setting
        left = setting.goal - self.reference
        rate = self.rate
        if left == 0.0 and rate == 0.0:
            return
        greatest = setting.speed or inf
        acceleration = setting.acceleration
        if acceleration:
            wanted = copysign(min(greatest, sqrt(2 * acceleration * abs(left))), left)
            change = acceleration * dt
            rate += min(max(wanted - rate, -change), change)
        else:
            rate = copysign(greatest, left)
        if abs(left) <= abs(rate) * dt and rate * left >= 0:
            self.reference, self.rate = setting.goal, 0.0
        else:
            self.reference += rate * dt
            self.rate = rate

    def _drive(self, dt: float, duty: float) -> None:
        """DC motor, back-EMF implicit: i = (duty·V − kt·ω)/R, τ = kt·i."""
        self.stand.there = False
        voltage = duty * (self.supply - CABLE * abs(self.current))
        self._turn(dt, voltage * self._torque_per_volt, self._back_emf)
        self.duty = duty
        self.current = voltage / self.model.resistance - self._torque_per_volt * self.velocity

    def _coast(self, dt: float) -> None:
        """No current: only gravity and friction; the reference stays with the joint."""
        self._turn(dt, 0.0, self.model.viscous)
        self.duty = self.current = self.rate = 0.0
        self.reference = self.position

    def _wear(self, dt: float) -> None:
        """Heat by i²R, and the alarms of the Shutdown register's default (overheating, overload)."""
        heat = self.current * self.current * self.model.resistance
        self.temperature += dt * COOLING * (HEATING * heat - self.temperature + self.ambient)
        if -OVERLOAD_DUTY < self.duty < OVERLOAD_DUTY:
            self._strain = 0.0
        else:
            self._strain += dt
            if self._strain > OVERLOAD_AFTER:
                self.trip("overload")
        if self.temperature > self.temperature_limit and not self.shutdown:
            self.trip("overheat")
