"""Who is named that holds the loop: real signals, in processes whose alarm nobody else needs."""

import ast
import signal
import subprocess
import sys
import textwrap
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import FrameType, SimpleNamespace

import pytest

from bentod import culprit
from bentod.culprit import GARBAGE, IDLE, AlarmLookout, Lookout, place
from bentod.pace import OVERDUE

ROOT = Path(__file__).parents[1]

PRELUDE = """
import asyncio, functools, gc, os, signal, subprocess, sys, time
from bentod.culprit import AlarmLookout
from bentod.clock import SystemClock

lookout = AlarmLookout()

def spin(seconds):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        pass

async def watched(hold):
    loop = asyncio.get_running_loop()
    loop.add_signal_handler(signal.SIGTERM, print)  # asyncio hears of every signal from here on
    with lookout:
        lookout.watch(loop.time(), loop.time(), 0.01)
        await hold()
        seen = dict(lookout.seen())
    return seen

def show(hold):
    print(repr(asyncio.run(watched(hold))))
"""


def seen(body: str) -> dict[str, float]:
    """What is seen while `body`, which defines an async `hold` and perhaps more, holds the loop."""
    return run(f"{PRELUDE}\n{textwrap.dedent(body)}\nshow(hold)\n")


def run(program: str) -> dict[str, float]:
    """What a program prints."""
    command = [sys.executable, "-W", "error", "-c", program]
    done = subprocess.run(command, capture_output=True, text=True, timeout=30, cwd=ROOT)
    assert done.returncode == 0, done.stderr
    assert "Traceback" not in done.stderr
    found = ast.literal_eval(done.stdout)
    assert isinstance(found, dict)
    return found


def longest(found: dict[str, float]) -> str:
    return max(found, key=lambda place: found[place])


def test_a_callback_that_computes_for_long_is_named() -> None:
    found = seen("""
        async def hold():
            asyncio.get_running_loop().call_soon(spin, 0.15)
            await asyncio.sleep(0.16)
    """)
    assert longest(found).endswith(" spin()")
    assert found[longest(found)] > 0.1


def test_the_innermost_code_of_ours_is_named_and_not_what_it_calls() -> None:
    found = seen("""
        import json
        from bentod.messages import encode_request
        async def hold():
            end = time.monotonic() + 0.15
            while time.monotonic() < end:
                encode_request(1, "x", {str(i): [i] * 10 for i in range(20)})
    """)
    assert any(where.startswith("bentod/") for where in found)
    assert all(not where.startswith("bentod/cli") for where in found)


def test_a_callback_that_sleeps_in_the_system_is_named_too_and_sleeps_as_long_as_it_wants() -> None:
    found = seen("""
        def doze():
            began = time.monotonic()
            time.sleep(0.15)
            assert time.monotonic() - began >= 0.15
        async def hold():
            asyncio.get_running_loop().call_soon(doze)
            await asyncio.sleep(0.16)
    """)
    assert longest(found).endswith(" doze()")


def test_a_loop_that_waits_is_idle_and_waits_as_long_as_it_wants() -> None:
    found = seen("""
        async def hold():
            async with SystemClock() as clock:
                deadline = clock.now() + 0.1
                await clock.sleep_until(deadline)
                assert clock.now() >= deadline
                await asyncio.sleep(0.05)
    """)
    assert longest(found) == IDLE


def test_collections_of_garbage_are_told_from_the_code_that_they_interrupt() -> None:
    found = seen("""
        many = [[i] for i in range(2_000_000)]
        async def hold():
            for _ in range(3):
                gc.collect()
    """)
    assert longest(found) == GARBAGE


def test_alarms_disturb_neither_processes_nor_pipes() -> None:
    found = seen("""
        async def hold():
            child = await asyncio.create_subprocess_exec(
                sys.executable, "-c", "import sys, time; time.sleep(0.1); print(sys.stdin.read())",
                stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            )
            out, _ = await child.communicate(b"still here")
            assert (child.returncode, out) == (0, b"still here\\n")
            near, far = os.pipe()
            os.write(far, b"x")
            assert os.read(near, 1) == b"x"
            quick = subprocess.run([sys.executable, "-c", "print(1)"], capture_output=True)
            assert quick.stdout == b"1\\n"
    """)
    assert IDLE in found


def test_a_serial_port_is_read_through_alarms() -> None:
    found = seen("""
        import pty, serial, threading
        near, far = pty.openpty()
        async def hold():
            with serial.Serial(os.ttyname(far), timeout=5) as port:
                threading.Timer(0.1, os.write, (near, b"abc")).start()
                assert port.read(3) == b"abc"
                port.write(b"def")
                assert os.read(near, 3) == b"def"
    """)
    assert sum(found.values()) > 0.05


def test_what_is_on_time_is_never_interrupted() -> None:
    found = seen("""
        async def hold():
            for _ in range(20):
                lookout.watch(time.monotonic() + 60, time.monotonic(), 0.01)
                spin(0.01)
    """)
    assert found == {}


HELD = """
import pathlib, tempfile, threading
import bentod.pace
from bentod.config_tables import Realtime
from bentod.daemon import Daemon
from bentod.publisher import Publisher
from bentod.realtime import upkeep
from bentod.supervise import Supervisor
from tests.rig import PLAIN, quiet_config

bentod.pace.QUIET = 0.0  # a machine that stutters before must not silence what matters here
late = []
publish = Publisher.publish

def listen(self, frame, events, whole):
    late.extend(event.text for event in events if event.kind == "late")
    publish(self, frame, events, whole)
    if frame.tick == 5:
        asyncio.get_running_loop().call_soon(HOLD)

Publisher.publish = listen

async def daemon(ticks=0, rate_hz=30):
    config = quiet_config(PLAIN, ("rate_hz = 30", f"rate_hz = {rate_hz}"))
    async with SystemClock() as clock:
        with upkeep(Realtime(), clock) as around, tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder, "bentod.sock")
            return await Daemon(config, clock, Supervisor(), path, upkeep=around).run(ticks)
"""

DAEMON = """
HOLD = functools.partial(spin, 0.5)
asyncio.run(daemon(ticks=20))
print(repr(dict.fromkeys(late, 0.0)))
"""


def test_a_daemon_whose_loop_was_held_says_by_whom() -> None:
    done = run(PRELUDE + HELD + DAEMON)
    assert any("ticks were missed" in line and " spin() held the loop for about " in line for line in done)


ENDED = """
def HOLD():
    threading.Timer(0.9 * HOG, os.kill, (os.getpid(), signal.SIGTERM)).start()
    spin(HOG)

print(repr({asyncio.run(daemon(rate_hz=RATE)): 0.0}))
"""


@pytest.mark.parametrize(("rate_hz", "hog"), [(30, 0.5), (1000, 1.0)])
def test_a_daemon_that_is_asked_to_end_while_its_loop_is_held_ends(rate_hz: int, hog: float) -> None:
    done = run(f"{PRELUDE}{HELD}\nRATE, HOG = {rate_hz}, {hog}\n{ENDED}")
    assert list(done) == ["The arm was left limp."]


def test_alarm_and_timer_are_as_they_were_afterwards() -> None:
    handler, (left, every) = signal.getsignal(signal.SIGALRM), signal.getitimer(signal.ITIMER_REAL)
    with AlarmLookout() as lookout:
        assert signal.getsignal(signal.SIGALRM) != handler
        lookout.watch(0.0, 0.0, 60.0)
    assert signal.getsignal(signal.SIGALRM) == handler
    now_left, now_every = signal.getitimer(signal.ITIMER_REAL)
    assert now_every == every
    assert (now_left > 0) == (left > 0)


def test_outside_the_main_thread_there_is_no_lookout() -> None:
    refused: list[Exception] = []

    def enter() -> None:
        try:
            AlarmLookout().__enter__()
        except ValueError as error:
            refused.append(error)

    thread = threading.Thread(target=enter)
    thread.start()
    thread.join()
    assert len(refused) == 1


def test_a_lookout_that_is_none_sees_nothing() -> None:
    lookout = Lookout()
    lookout.watch(0.0, 1.0, 0.1)
    assert lookout.seen() == {}


@pytest.fixture
def armed() -> Iterator[AlarmLookout]:
    """Its alarm is far away."""
    with AlarmLookout() as lookout:
        lookout.watch(time.monotonic(), time.monotonic(), 1000.0)
        yield lookout


def test_an_alarm_that_fails_leaves_the_code_alone_that_it_interrupts(
    armed: AlarmLookout, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(frame: FrameType | None) -> str:
        raise RecursionError

    monkeypatch.setattr(culprit, "place", fail)
    signal.setitimer(signal.ITIMER_REAL, 0)
    armed._overdue(0, sys._getframe())
    assert armed.seen() == {}
    assert signal.getitimer(signal.ITIMER_REAL)[0] > 0


def test_an_alarm_that_was_on_its_way_when_its_tick_ended_says_nothing_of_the_next(
    armed: AlarmLookout,
) -> None:
    armed.watch(time.monotonic() + 1000.0, time.monotonic(), 1000.0)
    armed._overdue(0, sys._getframe())
    assert armed.seen() == {}
    assert signal.getitimer(signal.ITIMER_REAL)[0] > 1500


def test_an_alarm_that_was_on_its_way_at_the_end_sets_no_other() -> None:
    with AlarmLookout() as lookout:
        lookout.watch(time.monotonic(), time.monotonic(), 1000.0)
    before = signal.getitimer(signal.ITIMER_REAL)
    lookout._overdue(0, sys._getframe())
    assert lookout.seen() == {}
    assert (signal.getitimer(signal.ITIMER_REAL)[0] > 0) == (before[0] > 0)


@pytest.mark.parametrize("rate_hz", [30.0, 200.0, 1000.0])
def test_a_day_of_alarms_leaves_room_for_other_signals(
    monkeypatch: pytest.MonkeyPatch, rate_hz: float
) -> None:
    now, alarms, timer = 0.0, 0, 0.0

    def set_timer(which: int, seconds: float) -> tuple[float, float]:
        nonlocal timer
        timer = seconds
        return 0.0, 0.0

    monkeypatch.setattr(culprit, "signal", SimpleNamespace(setitimer=set_timer, ITIMER_REAL=0))
    monkeypatch.setattr(culprit, "time", SimpleNamespace(monotonic=lambda: now))
    lookout = AlarmLookout()
    lookout.watch(now, now, OVERDUE / rate_hz)
    while now < 86_400:
        now, alarms = now + timer, alarms + 1
        lookout._overdue(0, sys._getframe())
    assert alarms < 50
    assert sum(lookout.seen().values()) == pytest.approx(now)


async def test_an_alarm_that_interrupts_an_alarm_names_the_code_below_both(armed: AlarmLookout) -> None:
    lookout = armed
    lookout._overdue(0, sys._getframe())
    (direct,) = lookout.seen()
    inner: list[str] = []

    class Interrupting(dict[str, float]):
        def get(self, key: str, default: float = 0.0) -> float:  # type: ignore[override]
            inner.append(place(sys._getframe(1)))
            return default

    lookout._held = Interrupting()
    lookout._overdue(0, sys._getframe())
    assert [where.partition(":")[0] for where in inner] == [direct.partition(":")[0]]


async def test_code_of_others_is_named_by_the_callback_that_the_loop_called() -> None:
    assert place(sys._getframe()).startswith("tests/test_culprit.py:")
    assert place(None) == IDLE
