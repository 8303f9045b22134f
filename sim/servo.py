"""One joint-mode servo as a pure `step(dt)`: dead time, profile, P controller, motor, friction, sensors.

The controller law and the motor constants are from Rhoban/bam (Apache-2.0; Duclusaud et al., ICRA 2025).
Dead time: Smith & Jivraj's measurements on AX-12+. Thermal constants, the overload rule and the cable's
resistance are assumed. Not modelled: backlash, gear compliance, jerk of the profile, filtering of the
present speed, I and D gains, Stribeck friction, coupling between joints, contact. No number that comes
out of here was ever compared with a real servo.
"""

import random
from collections import deque
from dataclasses import dataclass
from math import copysign, inf, pi, sin, sqrt

from sim.servo_models import ServoModel

TICK = 2 * pi / 4096
"""rad of one step of the position sensor."""

CENTRE = 2048
"""Position register at 0 rad."""

SPEED_STEP = 0.114 * 2 * pi / 60
"""rad/s of one step of the speed register."""

DUTY_PER_GAIN = 0.158
"""Duty per rad of error and unit of the P register (bam)."""

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


@dataclass(frozen=True, slots=True)
class Link:
    """What hangs on the output shaft."""

    gravity: float = 0.0  # N m when it points sideways
    rest: float = 0.0  # rad, where it hangs still
    inertia: float = 0.0  # kg m², without the servo's own armature
    low: float = -pi  # rad, hard stop
    high: float = pi  # rad, hard stop


@dataclass(frozen=True, slots=True)
class Setting:
    """What the servo is told; it takes effect after the dead time."""

    goal: float = 0.0  # rad
    speed: float = 0.0  # rad/s, 0: as fast as it can
    torque_on: bool = False
    acceleration: float = 0.0  # rad/s², 0: at once
    torque_limit: float = 1.0  # share of the greatest duty
    p_gain: int = 32  # register


@dataclass(frozen=True, slots=True)
class Reading:
    """What the servo's sensors say, in its own quantisation."""

    ticks: int  # position, 2048 at 0 rad
    speed: int  # signed, 0.114 rpm
    load: float  # duty, -1..1
    voltage: float  # V
    temperature: float  # degrees Celsius
    current: float  # A
    moving: bool


class Servo:
    """A servo with what hangs on it. Positions in rad, 0 at the centre, counter-clockwise positive."""

    def __init__(
        self, model: ServoModel, link: Link, position: float = 0.0, dead_time: float = 0.017, seed: str = ""
    ) -> None:
        self.model = model
        self.link = link
        self.time = 0.0
        self.position = position
        self.velocity = 0.0
        self.reference = position
        self.duty = 0.0
        self.current = 0.0
        self.temperature = ROOM
        self.temperature_limit = 80.0
        self.shutdown = ""
        """The alarm that cut the torque, "overload" or "overheat"; empty when none did."""
        self.boots = 0
        """Times that power came back: whoever keeps registers for this servo then starts afresh."""
        self.powered = True
        self.silent = False
        self.stuck = False
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
        self._rate = 0.0
        self._strain = 0.0
        self._queue: deque[tuple[float, Setting]] = deque()
        self._setting = Setting(position)
        self._inertia = model.armature + link.inertia
        self._torque_per_volt = model.torque_constant / model.resistance
        self._back_emf = model.torque_constant * self._torque_per_volt + model.viscous
        self._stiffness = DUTY_PER_GAIN * self._setting.p_gain
        self._greatest = GREATEST_DUTY

    @property
    def answers(self) -> bool:
        """Whether it hears and replies on the bus."""
        return self.powered and not self.silent

    def tell(self, setting: Setting) -> None:
        """Queue `setting`; settings take effect in order, each no sooner than the dead time from now."""
        due = self.time + self.dead_time + self.slowness
        if self._queue:
            due = max(due, self._queue[-1][0])
        self._queue.append((due, setting))

    def step(self, dt: float) -> None:
        """Let `dt` (s, about 0.001) pass."""
        self.time += dt
        while self._queue and self._queue[0][0] <= self.time:
            self._obey(self._queue.popleft()[1])
        if self._setting.torque_on and self.powered and not self.shutdown:
            self._follow(dt)
            error = self.reference - self.position
            duty = self._stiffness * error
            if abs(duty) > self._greatest:
                duty = copysign(self._greatest, duty)
            self._drive(dt, duty)
        else:
            self._coast(dt)
        self._wear(dt)

    def sense(self) -> Reading:
        """Position, speed, load and the rest, as the registers would show them."""
        ticks = round(self.position / TICK) + CENTRE
        if self.glitch_rate and self._random.random() < self.glitch_rate:
            ticks = self._random.randrange(4096)
        return Reading(
            ticks=min(max(ticks, 0), 4095),
            speed=round(self.velocity / SPEED_STEP),
            load=min(max(self.duty + self.load_offset, -1.0), 1.0),
            voltage=self.supply - CABLE * abs(self.current),
            temperature=self.temperature,
            current=self.current,
            moving=abs(self._setting.goal - self.reference) > TICK / 2,
        )

    def errors(self) -> tuple[str, ...]:
        """Standing complaints, in the manual's words; also what the bits of a status packet say."""
        found = []
        if not 6.0 <= self.supply <= 16.0:
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

    def power(self, on: bool) -> None:
        """Cut or restore the supply; it comes back limp and with its registers at their defaults."""
        if on and not self.powered:
            self.boots += 1
            self._queue.clear()
            self._setting = Setting(self.position)
            self.shutdown = ""
        self.powered = on

    def _obey(self, setting: Setting) -> None:
        self._setting = setting
        self._stiffness = DUTY_PER_GAIN * setting.p_gain
        self._greatest = min(GREATEST_DUTY, setting.torque_limit)

    def _follow(self, dt: float) -> None:
        """Move the reference towards the goal: v ≤ Moving Speed, v ≤ √(2a·distance), dv ≤ a·dt."""
        setting = self._setting
        left = setting.goal - self.reference
        if left == 0.0 and self._rate == 0.0:
            return
        greatest = setting.speed or inf
        acceleration = setting.acceleration
        if acceleration:
            wanted = copysign(min(greatest, sqrt(2 * acceleration * abs(left))), left)
            change = acceleration * dt
            self._rate += min(max(wanted - self._rate, -change), change)
        else:
            self._rate = copysign(greatest, left)
        arrived = abs(left) <= abs(self._rate) * dt and self._rate * left >= 0
        if arrived:
            self.reference, self._rate = setting.goal, 0.0
        else:
            self.reference += self._rate * dt

    def _drive(self, dt: float, duty: float) -> None:
        """DC motor, back-EMF implicit: i = (duty·V − kt·ω)/R, τ = kt·i."""
        voltage = duty * (self.supply - CABLE * abs(self.current))
        self._turn(dt, voltage * self._torque_per_volt, self._back_emf)
        self.duty = duty
        self.current = voltage / self.model.resistance - self._torque_per_volt * self.velocity

    def _coast(self, dt: float) -> None:
        """No current: only gravity and friction; the reference stays with the joint."""
        self._turn(dt, 0.0, self.model.viscous)
        self.duty = self.current = self._rate = 0.0
        self.reference = self.position

    def _turn(self, dt: float, torque: float, damping: float) -> None:
        """Newton, friction implicit: (J + d·dt)·ω' + c·dt·sign ω' = J·ω + τ·dt; within c it sticks."""
        link = self.link
        if link.gravity:
            torque += link.gravity * sin(link.rest - self.position)
        momentum = self._inertia * self.velocity + dt * torque
        grip = dt * self.model.coulomb
        if self.stuck or abs(momentum) <= grip:
            self.velocity = 0.0
            return
        momentum -= copysign(grip, momentum)
        self.velocity = momentum / (self._inertia + dt * damping)
        self.position += dt * self.velocity
        if not link.low <= self.position <= link.high:
            self.position = min(max(self.position, link.low), link.high)
            self.velocity = 0.0

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
