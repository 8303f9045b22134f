"""A report for a person, and for a program."""

from collections.abc import Iterator
from math import degrees as in_degrees

from bentod.frames import Value
from drivers.dynamixel.doctor.findings import limits
from drivers.dynamixel.doctor.pace import RATES, Pace
from drivers.dynamixel.doctor.visit import Report
from drivers.dynamixel.doctor.vitals import Vitals

COLUMNS = (
    ("ID", 3), ("model", 12), ("fw", 3), ("bit/s", 8), ("prot.", 5), ("delay", 6), ("level", 5),
    ("limits", 16), ("°C", 3), ("V", 5), ("P", 5), ("torque", 7), ("read", 14),
)  # fmt: skip


def lines(report: Report) -> Iterator[str]:
    """What was found, how fast it is, and what to do."""
    if report.timer is not None:
        yield f"Latency timer of the adapter: {report.timer} ms."
    yield "  ".join(name.ljust(width) for name, width in COLUMNS).rstrip()
    for servo in report.servos:
        cells = _cells(servo, report.reads.get(servo.id))
        yield "  ".join(cell.ljust(width) for cell, (_, width) in zip(cells, COLUMNS, strict=True)).rstrip()
    for baud, pace in report.rounds.items():
        yield ""
        yield from _pace_lines(baud, pace)
    yield ""
    yield from _finding_lines(report)


def as_values(report: Report) -> dict[str, Value]:
    """The same as JSON has it; times in s, angles in rad."""
    return {
        "healthy": report.healthy,
        "latency_timer_ms": report.timer,
        "servos": [_servo_values(servo, report.reads.get(servo.id)) for servo in report.servos],
        "rounds": [{"baud": baud, **_pace_values(pace)} for baud, pace in report.rounds.items()],
        "findings": [
            {"text": one.text, "remedy": one.remedy, "fixable": one.repair is not None, "note": one.note}
            for one in report.findings
        ],
        "mended": list(report.mended),
    }


def _cells(servo: Vitals, read: Pace | None) -> tuple[str, ...]:
    its = limits(servo)
    name = servo.name or ("?" if servo.number is None else f"no. {servo.number}")
    torque = servo.raw.get("Torque Enable")
    return (
        str(servo.id),
        name,
        _shown(servo.raw.get("Firmware Version")),
        str(servo.baud),
        f"{servo.protocol}.0",
        _shown(servo.value("Return Delay Time"), 1e6, "{:.0f}µs"),
        _shown(servo.raw.get("Status Return Level")),
        f"{in_degrees(its[0]):.0f}° … {in_degrees(its[1]):.0f}°" if its else "–",
        _shown(servo.value("Present Temperature"), 1, "{:.0f}"),
        _shown(servo.value("Present Voltage", "Present Input Voltage"), 1, "{:.1f}"),
        _shown(servo.raw.get("P Gain", servo.raw.get("Position P Gain"))),
        "–" if torque is None else ("on" if torque else "off"),
        _shown(read.median if read else None, 1e3, "{:.1f} ms")
        + (f" ({read.lost} lost)" if read and read.lost else ""),
    )


def _shown(value: float | None, factor: float = 1, form: str = "{:.0f}") -> str:
    return "–" if value is None else form.format(value * factor)


def _pace_lines(baud: int, pace: Pace) -> Iterator[str]:
    yield (
        f"At {baud} bit/s, reading all and writing all takes {pace.median * 1e3:.1f} ms, "
        f"99 of 100 times less than {pace.p99 * 1e3:.1f} ms: {pace.rate:.0f} rounds a second "
        f"({pace.lost} of {pace.count} incomplete)."
    )
    for rate in RATES:
        usual, worst = pace.median * rate, pace.p99 * rate
        # The driver gives a round of reading half a tick: beyond it, retries have no room.
        verdict = "fits" if worst <= 0.5 else "fits most times" if usual <= 0.5 else "does not fit"
        yield (
            f"  {rate:3} Hz, {1000 / rate:4.1f} ms a tick: {verdict} "
            f"(a round takes {usual:.0%} of it, one in a hundred {worst:.0%})"
        )


def _finding_lines(report: Report) -> Iterator[str]:
    for sentence in report.mended:
        yield f"* {sentence}"
    for finding in report.findings:
        mark = "-" if finding.note else "!"
        yield f"{mark} {finding.text}" + (f" {finding.remedy}" if finding.remedy else "")
    count = sum(not finding.note for finding in report.findings)
    fixable = sum(finding.repair is not None for finding in report.findings)
    if report.healthy:
        yield "Nothing to mend."
    else:
        yield f"{count} to mend" + (f"; --fix can mend {fixable}." if fixable else ".")


def _servo_values(servo: Vitals, read: Pace | None) -> dict[str, Value]:
    its = limits(servo)
    return {
        "id": servo.id,
        "model": servo.name,
        "model_number": servo.number,
        "firmware": servo.raw.get("Firmware Version"),
        "protocol": servo.protocol,
        "baud": servo.baud,
        "limits_rad": [its[0], its[1]] if its else None,
        "error": servo.error,
        "registers": dict(servo.raw),
        "read": _pace_values(read) if read else None,
    }


def _pace_values(pace: Pace) -> dict[str, Value]:
    return {
        "median_s": pace.median,
        "p99_s": pace.p99,
        "count": pace.count,
        "lost": pace.lost,
        "rate_hz": pace.rate,
    }
