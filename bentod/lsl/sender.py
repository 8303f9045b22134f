"""What the daemon tells, as samples of streams that are opened when it is known what they hold."""

import logging
from collections.abc import Callable, Sequence
from functools import partial

from bentod.errors import BentodError
from bentod.frames import Value
from bentod.lsl import muscles
from bentod.lsl.markers import events_stream, marker
from bentod.lsl.state import Layout, layout_of, number, state_stream
from bentod.lsl.stream import OpenOutlet, Outlet, Rows, Stream, Table
from bentod.lsl.times import Clocks

_log = logging.getLogger(__name__)

YOUNG = 1.0
"""s after the daemon's start in which a frame may still lack predictions, and so channels."""

AWAY = 60.0
"""s that a frame may be from our clock when it comes: a process can be stopped for a while."""


class ForeignClock(BentodError):
    """The times that the daemon tells are not of this machine's clock, now.

    Examples: a socket that is forwarded from another machine, a recording that is replayed.
    """

    code = "clock"


class Sender:
    """Puts frames, blocks and events on the network, with the times at which they were."""

    def __init__(self, open_outlet: OpenOutlet, clocks: Clocks) -> None:
        self.told = 0
        """Samples sent since the start."""
        self._open = open_outlet
        self._clocks = clocks
        self._outlets: dict[str, Outlet] = {}
        self._described: dict[tuple[str, Layout | int], Outlet] = {}
        """By what their description follows from, in this connection."""
        self._layout: Layout | None = None
        self._arm = ""
        self._rate = 0.0
        self._about: dict[str, str] = {}
        self._sites: Value = None
        self._checked = False
        self._takers = {"state": self._take_frame, "emg": self._take_block, "events": self._take_event}

    def begin(self, info: Value, sites: Value) -> None:
        """A connection has begun; `get_info` and `emg_get` told this."""
        told = info if isinstance(info, dict) else {}
        self._arm = str(told.get("arm") or "arm")
        self._rate = number(told.get("rate_hz", 0.0))
        self._about = {"manufacturer": "bentod", "model": self._arm, "version": str(told.get("version", ""))}
        self._sites = sites
        self._checked = False
        self._described.clear()
        self._outlet("events", 1, partial(events_stream, self._arm, self._about))

    def take(self, topic: str, entry: Table) -> None:
        """Send one frame, block or event.

        Raises:
            ForeignClock: its time is not of our clock.
        """
        if not self._checked:
            self._check(number(entry.get("time")))
        self._takers[topic](entry)

    def close(self) -> None:
        """Take every stream from the network."""
        while self._outlets:
            self._outlets.popitem()[1].close()

    def _check(self, time: float) -> None:
        away = time - self._clocks.monotonic()
        if not abs(away) <= AWAY:
            raise ForeignClock(
                f"The daemon's times are {away:.0f} s from this machine's clock; the bound is {AWAY:g} s. "
                "Run this on the arm's own machine, where the arm is live: LSL carries the times to others."
            )
        self._checked = True

    def _take_frame(self, frame: Table) -> None:
        found = layout_of(frame)
        layout = self._layout
        if layout is None and number(frame.get("tick")) < YOUNG * self._rate:
            return
        if layout is None or not layout.holds(found):
            layout = self._layout = found
        describe = partial(state_stream, layout, self._arm, self._rate, self._about)
        outlet = self._outlet("state", layout, describe)
        self._push(outlet, layout.sample(frame), [number(frame.get("time"))])

    def _take_block(self, block: Table) -> None:
        samples = muscles.samples_of(block)
        rate, channels = muscles.rate_of(self._sites), samples.shape[1]
        if len(samples) and rate:
            describe = partial(muscles.emg_stream, self._sites, channels, self._arm, self._about)
            outlet = self._outlet("emg", channels, describe)
            self._push(outlet, samples, muscles.times_of(block, len(samples), rate))

    def _take_event(self, event: Table) -> None:
        outlet = self._outlet("events", 1, partial(events_stream, self._arm, self._about))
        self._push(outlet, [marker(event)], [number(event.get("time"))])

    def _push(self, outlet: Outlet, rows: Rows, times: Sequence[float]) -> None:
        """Send samples of monotonic `times` (s)."""
        offset = self._clocks.offset()
        outlet.push(rows, [time + offset for time in times])
        self.told += len(times)

    def _outlet(self, topic: str, held: Layout | int, describe: Callable[[], Stream]) -> Outlet:
        """The stream of a topic that holds this; the same as before a restart of the daemon, if it can be."""
        if outlet := self._described.get((topic, held)):
            return outlet
        stream = describe()
        outlet = self._outlets.get(topic)
        if outlet is None or outlet.stream != stream:
            outlet = self._renewed(topic, stream)
        self._described[topic, held] = outlet
        return outlet

    def _renewed(self, topic: str, stream: Stream) -> Outlet:
        if old := self._outlets.pop(topic, None):
            _log.warning("%s is put up anew, because it has changed", stream.name)
            old.close()
            self._described.clear()
        outlet = self._outlets[topic] = self._open(stream)
        _log.info(
            "%s: %d channels, found by source_id '%s'", stream.name, len(stream.channels), stream.source_id
        )
        return outlet
