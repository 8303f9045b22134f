"""The doctor visits simulated buses, in virtual time."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from bentod.contracts import ArmConfig
from bentod.errors import BusError
from bentod.frames import Value
from drivers.dynamixel.doctor.text import as_values, lines
from drivers.dynamixel.doctor.visit import Plan, Report, Visit
from drivers.dynamixel.latency_timer import LatencyTimer
from drivers.stream import ByteStream
from sim.bento import bento_joints, build_arm, build_bus
from sim.clock import VirtualClock
from sim.dynamixel import tables1, tables2
from sim.dynamixel.device import Device
from sim.line import Line
from sim.options import parse_options

MX_1 = ("MX-64", "MX-106", "MX-28", "MX-28", "MX-28")
MX_2 = ("MX-64(2.0)", "MX-106(2.0)", "MX-28(2.0)", "MX-28(2.0)", "MX-28(2.0)")
MIXED = ("MX-64(2.0)", "MX-106", "AX-12A", "MX-28(2.0)", "MX-28")
IDS = tuple(range(8))
MEGABAUD = 1_000_000


class Patient:
    """A bus of simulated servos, and everything that is sent to it."""

    def __init__(self, clock: VirtualClock, tmp_path: Path, models: Sequence[str] = MX_1) -> None:
        joints = tuple(
            replace(spec, hardware={**spec.hardware, "model": model})
            for spec, model in zip(bento_joints(), models, strict=True)
        )
        config = ArmConfig(joints, 1 / 30, {})
        options = parse_options(config)
        self.arm = build_arm(config, options, clock.now())
        self.bus = build_bus(self.arm, config, options)
        self.latency = 0.001
        self.drop = 0.0
        self._clock = clock
        self._adapters = tmp_path

    def device(self, id_: int) -> Device:
        return next(device for device in self.bus.devices if device.id == id_)

    def settings(self) -> list[list[int]]:
        """Whatever of servos with firmware 1 can be written."""
        cells = [cell for cell in tables1.MX_28.cells if cell.writable]
        return [[device.get(cell) for cell in cells] for device in self.bus.devices]

    def open(self, baud: int) -> ByteStream:
        self.bus.baud = baud
        line = Line(self.bus, self.arm, "doctor", self.latency)
        line.drop = self.drop
        return line

    async def visit(self, *bauds: int, fix: bool = False) -> Report:
        timer = LatencyTimer("ttyUSB0", self._adapters)
        plan = Plan(bauds or (MEGABAUD,), IDS, fix=fix)
        return await Visit(self.open, timer, self._clock, lambda line: None).run(plan)


@pytest.fixture
async def patient(clock: VirtualClock, tmp_path: Path) -> Patient:
    return Patient(clock, tmp_path)


def texts(report: Report) -> str:
    return "\n".join(finding.text for finding in report.findings if not finding.note)


@pytest.mark.parametrize("models", [MX_1, MX_2, MIXED])
async def test_a_healthy_arm_is_found_whole_and_left_alone(
    models: Sequence[str], clock: VirtualClock, tmp_path: Path
) -> None:
    patient = Patient(clock, tmp_path, models)
    report = await patient.visit()
    assert sorted((servo.id, servo.name) for servo in report.servos) == list(enumerate(models, 1))
    assert {servo.protocol for servo in report.servos} == {2 if "2.0" in name else 1 for name in models}
    assert texts(report) == ""
    assert report.healthy


async def test_a_visit_writes_nothing_and_arms_nobody(patient: Patient) -> None:
    before = patient.settings()
    positions = [servo.position for servo in patient.arm.servos if not servo.link.gravity]
    await patient.visit(fix=True)
    assert patient.settings() == before
    assert [servo.position for servo in patient.arm.servos if not servo.link.gravity] == positions
    assert not any(device.get(tables1.TORQUE_ENABLE) for device in patient.bus.devices)


async def test_a_return_delay_is_found_with_its_number_and_mended(patient: Patient) -> None:
    patient.device(3).provision(tables1.RETURN_DELAY, 250)
    report = await patient.visit()
    assert texts(report) == "Servo 3 waits 500 µs before each reply (Return Delay Time 250); it could be 0."
    assert not report.healthy
    mended = await patient.visit(fix=True)
    assert mended.mended == ["Servo 3: Return Delay Time is 0 now."]
    assert mended.healthy
    assert patient.device(3).get(tables1.RETURN_DELAY) == 0


@pytest.mark.parametrize("level", [0, 1])
async def test_a_servo_that_does_not_confirm_is_found_and_mended(patient: Patient, level: int) -> None:
    patient.device(2).provision(tables1.RETURN_LEVEL, level)
    assert "Status Return Level" in texts(await patient.visit())
    assert (await patient.visit(fix=True)).healthy
    assert patient.device(2).get(tables1.RETURN_LEVEL) == 2


async def test_firmware_2_is_mended_as_well(clock: VirtualClock, tmp_path: Path) -> None:
    patient = Patient(clock, tmp_path, MX_2)
    patient.device(4).provision(tables2.RETURN_DELAY, 100)
    assert "Servo 4 waits 200 µs" in texts(await patient.visit())
    assert (await patient.visit(fix=True)).healthy


async def test_nothing_is_mended_in_a_servo_that_holds_something(patient: Patient) -> None:
    patient.device(3).provision(tables1.RETURN_DELAY, 250)
    patient.device(3).provision(tables1.TORQUE_ENABLE, 1)
    report = await patient.visit(fix=True)
    assert "because its torque is on" in report.mended[0]
    assert not report.healthy
    assert patient.device(3).get(tables1.RETURN_DELAY) == 250
    assert patient.device(3).get(tables1.TORQUE_ENABLE) == 1


async def test_servos_at_two_rates_are_found_and_named(patient: Patient) -> None:
    patient.device(5).provision(tables1.BAUD, 34)
    report = await patient.visit(MEGABAUD, 57_600)
    assert "5 at 57600 bit/s; 1, 2, 3, 4 at 1000000 bit/s" in texts(report)


async def test_wheel_mode_is_found(patient: Patient) -> None:
    patient.device(1).provision(tables1.CW_LIMIT, 0)
    patient.device(1).provision(tables1.CCW_LIMIT, 0)
    assert "Servo 1 is in wheel mode" in texts(await patient.visit())


async def test_a_servo_that_does_not_protect_itself_is_found(patient: Patient) -> None:
    patient.device(1).provision(tables1.SHUTDOWN, 4)
    assert "Servo 1 has a Shutdown of 4" in texts(await patient.visit())


@pytest.mark.parametrize(
    ("fault", "words"),
    [
        ("overheat", "Servo 2 is at 90 degrees Celsius"),
        ("low_voltage", "Servo 2 is supplied with 5.5 V; it should be 11.0 to 16.0 V"),
        ("overload", "Servo 2 reports Overload Error"),
    ],
)
@pytest.mark.parametrize("models", [MX_1, MX_2])
async def test_a_servo_in_trouble_is_found_with_its_trouble(
    models: Sequence[str], fault: str, words: str, clock: VirtualClock, tmp_path: Path
) -> None:
    patient = Patient(clock, tmp_path, models)
    patient.arm.inject(fault, 1, True)
    assert words in texts(await patient.visit())


async def test_firmware_2_that_speaks_protocol_1_is_found(clock: VirtualClock, tmp_path: Path) -> None:
    patient = Patient(clock, tmp_path, MX_2)
    patient.device(3).provision(tables2.PROTOCOL_TYPE, 1)
    assert "Servo 3 has firmware for protocol 2.0 and speaks 1.0" in texts(await patient.visit())


async def test_a_good_adapter_does_more_than_200_rounds_a_second(patient: Patient) -> None:
    report = await patient.visit()
    assert 200 < report.rounds[MEGABAUD].rate < 500
    assert report.reads[1].median == pytest.approx(0.0014, abs=0.0003)


async def test_an_adapter_that_waits_does_not_reach_100_hz(patient: Patient) -> None:
    patient.latency = 0.016
    report = await patient.visit()
    assert 45 < report.rounds[MEGABAUD].rate < 65
    assert "At 1000000 bit/s a round takes" in texts(report)
    shown = "\n".join(lines(report))
    assert "100 Hz, 10.0 ms a tick: does not fit" in shown


async def test_a_line_that_loses_packets_is_found(patient: Patient) -> None:
    patient.drop = 0.05
    assert "rounds were incomplete" in texts(await patient.visit())


async def test_the_latency_timer_is_read_judged_and_set(patient: Patient, tmp_path: Path) -> None:
    timer = tmp_path / "ttyUSB0" / "latency_timer"
    timer.parent.mkdir()
    timer.write_text("16\n", encoding="ascii")
    assert "latency timer is 16 ms" in texts(await patient.visit())
    assert (await patient.visit(fix=True)).healthy
    assert timer.read_text(encoding="ascii") == "1\n"


async def test_a_port_that_cannot_be_opened_is_an_error(clock: VirtualClock, tmp_path: Path) -> None:
    def refuse(baud: int) -> ByteStream:
        raise BusError("no such port.")

    visit = Visit(refuse, LatencyTimer("ttyUSB0", tmp_path), clock, lambda line: None)
    with pytest.raises(BusError, match=r"^no such port\.$"):
        await visit.run(Plan((MEGABAUD, 57_600), IDS))


async def test_an_empty_bus_has_no_servos(patient: Patient) -> None:
    patient.arm.inject("power", None, True)
    report = await patient.visit()
    assert report.servos == []


async def test_the_report_for_programs_says_the_same(patient: Patient) -> None:
    patient.device(3).provision(tables1.RETURN_DELAY, 250)
    values = as_values(await patient.visit())
    assert values["healthy"] is False
    servos, findings = values["servos"], values["findings"]
    assert isinstance(servos, list)
    assert isinstance(findings, list)
    assert len(servos) == 5
    assert _fixable(findings[0])


def _fixable(finding: Value) -> bool:
    return isinstance(finding, dict) and finding["fixable"] is True
