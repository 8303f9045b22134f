"""Linux' joystick events: bytes in, the state of axes and buttons out. No input or output here."""

import struct
from collections.abc import Iterable

RECORD = struct.Struct("<IhBB")
"""js_event of <linux/joystick.h>: time (ms), value (signed), type, number."""

BUTTON = 0x01
AXIS = 0x02
INITIAL = 0x80
"""Or-ed to the type: not an event but the state, told at opening and after the kernel's queue overflowed."""

FULL = 32767
"""An axis at its end (Documentation/input/joydev/joystick-api.rst)."""

MOST = 128
"""Axes, and buttons, that are looked at; the kernel's tables end at 64 and at 80 of each."""


class Controls:
    """Axes and buttons as the events so far tell them."""

    def __init__(self) -> None:
        self._axes: list[float] = []
        self._buttons: list[bool] = []
        self._presses: list[int] = []
        self._rest = b""

    @property
    def axes(self) -> tuple[float, ...]:
        """-1..1, by number."""
        return tuple(self._axes)

    @property
    def buttons(self) -> tuple[bool, ...]:
        """Whether each is down, by number."""
        return tuple(self._buttons)

    @property
    def presses(self) -> tuple[int, ...]:
        """How often each was pressed. What the kernel tells as the initial state is no press."""
        return tuple(self._presses)

    def feed(self, data: bytes) -> None:
        """Take in what was read, in any pieces; records that are none are passed over."""
        data = self._rest + data
        whole = len(data) - len(data) % RECORD.size
        self._rest = data[whole:]
        self._take(RECORD.iter_unpack(data[:whole]))

    def _take(self, records: Iterable[tuple[int, ...]]) -> None:
        for _, value, kind, number in records:
            if number >= MOST:
                continue
            if kind & ~INITIAL == AXIS:
                _extend(self._axes, number, 0.0)
                self._axes[number] = max(-1.0, min(1.0, value / FULL))
            elif kind & ~INITIAL == BUTTON:
                self._press(number, bool(value), edge=not kind & INITIAL)

    def _press(self, number: int, down: bool, edge: bool) -> None:
        _extend(self._buttons, number, False)
        _extend(self._presses, number, 0)
        self._presses[number] += edge and down and not self._buttons[number]
        self._buttons[number] = down


def _extend(values: list[float] | list[bool] | list[int], number: int, value: float) -> None:
    values.extend([value] * (number + 1 - len(values)))  # type: ignore[list-item]  # the caller's kind of it
