"""What is wrong with a servo or with the line, as sentences: pure."""

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from drivers.dynamixel.codec import Version
from drivers.dynamixel.doctor.pace import Pace
from drivers.dynamixel.doctor.vitals import Vitals
from drivers.dynamixel.firmware1 import ERRORS, REFUSED
from drivers.dynamixel.firmware2 import ALERT, HARDWARE_ERRORS, OLDEST_WITH_WATCHDOG
from drivers.dynamixel.tables import ServoModel

WARM = 65.0
"""Degrees Celsius at which brachIOplexus warns."""

LOW = 11.0
"""V; assumed: what a 12 V supply should not sag to at rest."""

FULL = {"Max Torque": 1023, "PWM Limit": 885}
"""Raw values of the whole torque."""

LOSSES = 0.001
"""Share of rounds that may be incomplete on a sound line."""

POSITION_MODE = 3
"""Operating Mode: https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#operating-mode"""


@dataclass(frozen=True, slots=True)
class Repair:
    """A register that can be set safely, its torque being off."""

    id: int
    protocol: Version
    baud: int  # bit/s
    register: str
    value: int  # raw


@dataclass(frozen=True, slots=True)
class Finding:
    """Something to mend, or (a note) to know."""

    text: str  # a sentence with the number and the bound
    remedy: str = ""  # a sentence; empty when there is nothing to do
    repair: Repair | None = None
    note: bool = False


Judge = Callable[[Vitals, ServoModel], Iterator[Finding]]


def judge(servo: Vitals) -> list[Finding]:
    """Everything about one servo by itself."""
    model = servo.model
    if servo.number is None:
        return [_deaf(servo)]
    if model is None:
        return [Finding(f"{servo} has the model number {servo.number}, which is not known.", note=True)]
    return [finding for ask in JUDGES for finding in ask(servo, model)]


def judge_bauds(servos: Sequence[Vitals]) -> list[Finding]:
    """Servos of one bus must be at one rate."""
    rates = sorted({servo.baud for servo in servos})
    if len(rates) < 2:
        return []
    where = "; ".join(
        f"{', '.join(str(servo.id) for servo in servos if servo.baud == rate)} at {rate} bit/s"
        for rate in rates
    )
    return [
        Finding(
            f"Servos on one bus talk at {len(rates)} rates: {where}.",
            "Give all of them one, best 1000000 (`bentod servo set-baud`).",
        )
    ]


def judge_twins(servos: Sequence[Vitals]) -> list[Finding]:
    """Two servos with one id in different protocols or at different rates will meet once that is mended."""
    ids = [servo.id for servo in servos]
    return [
        Finding(f"{ids.count(id_)} servos have the ID {id_}.", "Give each its own (`bentod servo set-id`).")
        for id_ in sorted(set(ids))
        if ids.count(id_) > 1
    ]


def judge_timer(timer: int | None) -> list[Finding]:
    """The latency timer (ms) of the adapter while the port is open."""
    if timer is None or timer <= 1:
        return []
    return [
        Finding(
            f"The adapter's latency timer is {timer} ms: every short reply waits for it; 1 ms is best.",
            "Install config/99-bentod-dynamixel.rules, or write 1 to it as root.",
        )
    ]


def judge_pace(baud: int, pace: Pace, rate: float) -> list[Finding]:
    """Rounds at a rate (Hz) of ticks: half a tick is for reading, the driver waits no longer."""
    found: list[Finding] = []
    if pace.median * rate > 0.5:
        found.append(
            Finding(
                f"At {baud} bit/s a round takes {pace.median * 1e3:.1f} ms; at {rate:g} Hz it should take "
                f"no more than {500 / rate:.1f} ms.",
                "See the other findings; a faster rate helps too (`bentod servo set-baud`).",
            )
        )
    if pace.lost > LOSSES * pace.count:
        found.append(
            Finding(
                f"At {baud} bit/s {pace.lost} of {pace.count} rounds were incomplete; {LOSSES:.1%} may be.",
                "Look at the cables, their length, the supply and the adapter.",
            )
        )
    return found


def _deaf(servo: Vitals) -> Finding:
    # Status Return Level 0: https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#status-return-level
    return Finding(
        f"{servo} answers pings and nothing else; its Status Return Level is 0, or two servos have its ID.",
        "Set its Status Return Level to 2.",
        Repair(servo.id, servo.protocol, servo.baud, "Status Return Level", 2),
    )


def _return_delay(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    if raw := servo.raw.get("Return Delay Time", 0):
        yield Finding(
            f"{servo} waits {raw * 2} µs before each reply (Return Delay Time {raw}); it could be 0.",
            "Set its Return Delay Time to 0.",
            Repair(servo.id, servo.protocol, servo.baud, "Return Delay Time", 0),
        )


def _return_level(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    if (level := servo.raw.get("Status Return Level", 2)) != 2:
        yield Finding(
            f"{servo} has a Status Return Level of {level} and does not confirm orders; it must be 2.",
            "Set its Status Return Level to 2.",
            Repair(servo.id, servo.protocol, servo.baud, "Status Return Level", 2),
        )


def _mode(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    low, high = servo.raw.get(model.layout.lowest), servo.raw.get(model.layout.highest)
    if servo.protocol == 1 and low == high and low in (0, model.last_tick):
        kind = "wheel" if low == 0 else "multi-turn"
        yield Finding(
            f"{servo} is in {kind} mode: its CW and CCW Angle Limit are both {low}.",
            "Set them to the limits of its joint with the servo maker's tool.",
        )
    if (mode := servo.raw.get("Operating Mode", POSITION_MODE)) != POSITION_MODE:
        yield Finding(
            f"{servo} has an Operating Mode of {mode}; it must be {POSITION_MODE}, position control.",
            "Set it with the servo maker's tool.",
        )
    if mode := servo.raw.get("Drive Mode", 0):
        yield Finding(
            f"{servo} has a Drive Mode of {mode} and turns the wrong way or follows another; it must be 0.",
            "Set it with the servo maker's tool.",
        )


def _protocol(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    if servo.protocol != model.layout.protocol:
        yield Finding(
            f"{servo} has firmware for protocol {model.layout.protocol}.0 and speaks {servo.protocol}.0, "
            "which bentod does not with such firmware.",
            f"`bentod servo set-protocol PORT {servo.id} {model.layout.protocol}`.",
        )


def _shutdown(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    mask = servo.raw.get("Shutdown", model.layout.protected)
    if missing := model.layout.protected & ~mask:
        words = " and ".join(_bits(missing, ERRORS if servo.protocol == 1 else HARDWARE_ERRORS))
        yield Finding(
            f"{servo} has a Shutdown of {mask} and does not protect itself after an {words}; "
            f"it should be {mask | missing}.",
            "Set it with the servo maker's tool.",
        )


def _temperature(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    found, limit = servo.value("Present Temperature"), servo.value("Temperature Limit") or 80.0
    if found is not None and found >= min(WARM, limit):
        yield Finding(
            f"{servo} is at {found:.0f} degrees Celsius; from {WARM:.0f} on it is too warm, "
            f"and at {limit:.0f} it shuts down.",
            "Take the load off and let it cool.",
        )


def _voltage(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    found = servo.value("Present Voltage", "Present Input Voltage")
    low = max(servo.value("Min Voltage Limit") or 0.0, LOW)
    high = servo.value("Max Voltage Limit") or 16.0
    if found is not None and not low <= found <= high:
        yield Finding(
            f"{servo} is supplied with {found:.1f} V; it should be {low:.1f} to {high:.1f} V.",
            "Look at the supply, its fuse and the cables.",
        )


def _errors(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    if servo.protocol == 1:
        names = _bits(servo.error & ~REFUSED, ERRORS)
    else:
        names = _bits(servo.raw.get("Hardware Error Status", 0), HARDWARE_ERRORS)
        names = names or (["Alert"] if servo.error & ALERT else [])
    if names:
        yield Finding(f"{servo} reports {', '.join(names)}.", "Find the cause; then power it off and on.")
    if servo.raw.get("Torque Limit", 1) == 0:
        yield Finding(
            f"{servo} has a Torque Limit of 0: it has shut down after an alarm.",
            "Take the load off, let it cool, and power it off and on.",
        )


def _strength(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    for name, full in FULL.items():
        if 0 < (raw := servo.raw.get(name, full)) < full:
            yield Finding(
                f"{servo} has a {name} of {raw}: {raw / full:.0%} of its torque (full: {full}).", note=True
            )
    limit = servo.raw.get("Torque Limit", 0)
    if 0 < limit < servo.raw.get("Max Torque", 0):
        yield Finding(f"{servo} has a Torque Limit of {limit} until it is powered off.", note=True)


def _firmware(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    version = servo.raw.get("Firmware Version", OLDEST_WITH_WATCHDOG)
    if servo.protocol == 2 and version < OLDEST_WITH_WATCHDOG:
        yield Finding(
            f"{servo} has firmware {version}, which has no bus watchdog; {OLDEST_WITH_WATCHDOG} has.",
            "Renew it with the servo maker's tool.",
        )


def _torque(servo: Vitals, model: ServoModel) -> Iterator[Finding]:
    if servo.raw.get("Torque Enable"):
        yield Finding(f"{servo} has its torque on; nothing in it can be set so.", note=True)


JUDGES: tuple[Judge, ...] = (
    _return_delay, _return_level, _mode, _protocol, _shutdown, _temperature, _voltage, _errors, _strength,
    _firmware, _torque,
)  # fmt: skip


def limits(servo: Vitals) -> tuple[float, float] | None:
    """Angles (rad, 0 at the centre) between which a servo may be sent; None when it did not say."""
    model = servo.model
    names = (model.layout.lowest, model.layout.highest) if model else ()
    if model is None or not all(name in servo.raw for name in names):
        return None
    low, high = (
        (servo.raw[name] - model.centre) * model.tick for name in (model.layout.lowest, model.layout.highest)
    )
    return low, high


def degrees(*angles: float) -> str:
    """Angles (rad) for a person."""
    return " to ".join(f"{math.degrees(angle):.1f}" for angle in angles) + " degrees"


def _bits(mask: int, names: Sequence[str]) -> list[str]:
    return [name for bit, name in enumerate(names) if name and mask >> bit & 1]
