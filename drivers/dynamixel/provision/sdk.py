"""The servo maker's SDK behind a few typed functions, and around its defects; version 4.1.0 was read."""

import time
from collections.abc import Callable
from contextlib import suppress
from types import TracebackType
from typing import Self, TypeVar, cast

import serial
from dynamixel_sdk import COMM_SUCCESS, PacketHandler, PortHandler

from bentod.errors import BusError
from drivers.dynamixel.codec import CODECS, Version
from drivers.dynamixel.latency_timer import LatencyTimer
from drivers.dynamixel.packets import BROADCAST
from drivers.stream import FOREIGN, explain

T = TypeVar("T")

PATIENT, HASTY = 40.0, 6.0
"""ms to wait for a reply beyond its time on the wire and the adapter's latency timer: as long as writing an
EEPROM may take; and when IDs are asked one after the other, of which most are nobody's."""

SPIN = 0.001
"""s that a read of the port waits."""

EVERYTHING, ALL_BUT_ID, ALL_BUT_ID_AND_BAUD = 0xFF, 0x01, 0x02
"""What a reset of protocol 2.0 resets, https://emanual.robotis.com/docs/en/dxl/protocol2/#factory-reset-0x06."""


class _Port(PortHandler):  # type: ignore[misc]  # the SDK has no types
    """The SDK's port, for this program alone, at any rate, and with time-outs that fit."""

    patience = PATIENT
    is_open = False

    def setupPort(self, cflag_baud: int) -> bool:  # noqa: N802 -- the SDK's name
        """Open exclusively; the SDK lets a daemon and a tool talk at once, and reads without waiting."""
        if self.is_open:
            self.closePort()
        self.ser = serial.Serial(self.port_name, cflag_baud, timeout=SPIN, exclusive=True)
        with suppress(*FOREIGN):  # not every port has it
            self.ser.set_low_latency_mode(True)
        self.is_open = True
        self.tx_time_per_byte = 10_000.0 / cflag_baud
        return True

    def getCFlagBaud(self, baudrate: int) -> int:  # noqa: N802 -- the SDK's name
        """Any rate; the SDK refuses 57 142, 117 647, 250 000, 400 000, 2.25 M and 4.5 M bit/s."""
        return baudrate

    def setPacketTimeout(self, packet_length: int) -> None:  # noqa: N802 -- the SDK's name
        """The SDK waits at least 34 ms for each reply that does not come: 9 s for a scan instead of 2."""
        self.setPacketTimeoutMillis(self.tx_time_per_byte * packet_length + self.patience)

    def getCurrentTime(self) -> float:  # noqa: N802 -- the SDK's name
        """Ms that never jump; the SDK counts with the wall clock, which a time server may set."""
        return time.monotonic() * 1000


class Line:
    """Servos of one protocol behind a port at one rate."""

    def __init__(self, port: str, baud: int, protocol: Version) -> None:
        """Open the port. Raises BusError: it cannot be."""
        self.port = port
        self.baud = baud
        self.protocol = protocol
        self._handler = PacketHandler(float(protocol))
        self._timer = LatencyTimer(port)
        self._port = _Port(port)
        self._guarded(lambda: self._port.setBaudRate(baud))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._port.closePort()

    def ping(self, id_: int, hasty: bool = False) -> int | None:
        """The model number; None when nobody answers."""
        self._port.patience = (HASTY if hasty else PATIENT) + (self._timer.read() or 0)
        model, result, _ = self._guarded(lambda: self._handler.ping(self._port, id_))
        return cast("int", model) if result == COMM_SUCCESS else None

    def read(self, id_: int, address: int, size: int) -> int:
        """A register's raw value.

        Raises:
            BusError: no answer.
        """
        self._port.patience = PATIENT + (self._timer.read() or 0)
        # The read functions for 1, 2 and 4 bytes say 0 when they failed; this one has no data then.
        data, result, _ = self._guarded(lambda: self._handler.readTxRx(self._port, id_, address, size))
        if result != COMM_SUCCESS:
            raise BusError(f"Servo {id_} does not answer when asked for address {address}.")
        return int.from_bytes(bytes(data), "little")

    def write(self, id_: int, address: int, size: int, value: int) -> None:
        """Write a raw value. It is not said whether that worked: read it back.

        Its reply may come at another rate or from another ID than was asked, if that is what was written. The
        values of `provision` never hold FF FF FD, which the SDK sends without the stuffing of protocol 2.0.
        """
        self._port.patience = PATIENT + (self._timer.read() or 0)
        data = list(value.to_bytes(size, "little"))
        self._guarded(lambda: self._handler.writeTxRx(self._port, id_, address, size, data))

    def factory_reset(self, id_: int, scope: int) -> None:
        """Reset one servo; `scope` is for protocol 2.0 only.

        Raises:
            ValueError: all of them at once.
        """
        if id_ >= BROADCAST:
            raise ValueError("one servo at a time is reset, never all")
        self._port.patience = PATIENT + (self._timer.read() or 0)
        scopes = (scope,) if self.protocol == 2 else ()
        self._guarded(lambda: self._handler.factoryReset(self._port, id_, *scopes))

    def _guarded(self, ask: Callable[[], T]) -> T:
        try:
            return ask()
        except FOREIGN as error:
            raise BusError(explain(self.port, error), field="port") from error


PROTOCOLS: tuple[Version, ...] = tuple(CODECS)
