"""An amplifier's bridge to LSL, as a thread of the tests."""

import threading
import time
from types import ModuleType
from uuid import uuid4

import numpy as np

RATE_HZ = 500.0
CHUNK = 5  # samples


class Bridge:
    """Sends microvolts that count samples up in channel 0, and down in channel 1, from when it is entered."""

    def __init__(
        self,
        pylsl: ModuleType,
        rate_hz: float = RATE_HZ,
        form: str = "float32",
        unit: str = "microvolts",
        source_id: str = "",
    ) -> None:
        self.source_id = source_id or f"bridge-{uuid4()}"
        self.silent = threading.Event()
        """It sends nothing any more, though it is there."""
        self.ahead = 0.0
        """s that its stamps are ahead of LSL's clock."""
        self._lost = 0  # samples
        self._pylsl = pylsl
        info = pylsl.StreamInfo("Bridge", "EMG", 2, rate_hz, form, self.source_id)
        if unit:
            info.set_channel_units(unit)
        self._outlet = pylsl.StreamOutlet(info)
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._send if rate_hz and form != "string" else lambda: None)

    def __enter__(self) -> "Bridge":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.die()

    def lose(self, samples: int) -> None:
        """Lose samples on the way to it."""
        self._lost += samples

    def die(self) -> None:
        """Leave the network; idempotent."""
        self._end.set()
        self._thread.join()
        self._outlet = None

    def _send(self) -> None:
        begun = self._pylsl.local_clock() - CHUNK / RATE_HZ
        index = 0
        while not self._end.is_set():
            lost, self._lost = self._lost, 0
            index += lost
            counts = np.arange(index, index + CHUNK)
            index += CHUNK
            stamp = begun + (index - 1) / RATE_HZ
            time.sleep(max(0.0, stamp - self._pylsl.local_clock()))
            if not self.silent.is_set():
                chunk = np.column_stack((counts, -counts)).tolist()
                self._outlet.push_chunk(chunk, stamp + self.ahead)
