"""What the process asks of the system: granted, refused in a sentence, and given back."""

import ctypes
import gc
import logging
import os
import re
import resource
import signal
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from pydantic import ValidationError

import bentod.realtime
from bentod.collector import SlackCollector
from bentod.config_tables import HIGHEST_PRIORITY, Realtime
from bentod.culprit import AlarmLookout
from bentod.errors import ConfigError
from bentod.realtime import Upkeep, upkeep
from sim.clock import VirtualClock

NOTHING = Realtime(gc="python")


def may_have_priority() -> bool:
    """Whether the system grants SCHED_FIFO to a thread of this process."""

    def ask() -> bool:
        try:
            os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(1))
        except PermissionError:
            return False
        return True

    with ThreadPoolExecutor() as pool:  # whose thread is gone afterwards, with what it got
        return pool.submit(ask).result()


class System:
    """Stands for the operating system; grants everything that it was not told to refuse."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.said: list[str] = []
        self.refuses = ""
        self.policy = (os.SCHED_OTHER, 0)
        self.cpus = {0, 1}
        self.limit = resource.RLIM_INFINITY
        self.capabilities = 0
        monkeypatch.setattr(os, "sched_getscheduler", lambda pid: self.policy[0])
        monkeypatch.setattr(os, "sched_getparam", lambda pid: os.sched_param(self.policy[1]))
        monkeypatch.setattr(os, "sched_setscheduler", self._schedule)
        monkeypatch.setattr(os, "sched_getaffinity", lambda pid: set(self.cpus))
        monkeypatch.setattr(os, "sched_setaffinity", self._bind)
        monkeypatch.setattr(resource, "getrlimit", lambda which: (self.limit, self.limit))
        monkeypatch.setattr(ctypes, "CDLL", lambda *_, **__: self)
        monkeypatch.setattr(bentod.realtime, "_STATUS", self)

    def exists(self) -> bool:
        return True

    def read_text(self) -> str:
        return f"Name:\tbentod\nCapEff:\t{self.capabilities:016x}\n"

    def mlockall(self, flags: int) -> int:
        self.said.append(f"lock {flags}")
        return -1 if self.refuses == "memory" else 0

    def munlockall(self) -> int:
        self.said.append("unlock")
        return 0

    def _schedule(self, pid: int, policy: int, parameter: os.sched_param) -> None:
        if self.refuses == "priority":
            raise PermissionError(1, "Operation not permitted")
        self.policy = (policy, parameter.sched_priority)

    def _bind(self, pid: int, cpus: set[int]) -> None:
        if not cpus & {0, 1}:
            raise OSError(22, "Invalid argument")
        self.cpus = cpus & {0, 1}


@pytest.fixture
def system(monkeypatch: pytest.MonkeyPatch) -> System:
    return System(monkeypatch)


def test_by_default_a_process_asks_for_nothing_and_things_around_the_tick_do_nothing() -> None:
    idle = Upkeep()
    with idle.collector as collector:
        collector.collect(1.0)
        assert gc.isenabled()
    assert not isinstance(idle.lookout, AlarmLookout)


def test_priority_is_that_of_the_tick_alone_and_given_back(system: System, clock: VirtualClock) -> None:
    with upkeep(Realtime(priority=49), clock):
        assert system.policy == (os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, 49)
    assert system.policy == (os.SCHED_OTHER, 0)


@pytest.mark.skipif(not may_have_priority(), reason="this process may not use SCHED_FIFO")
def test_threads_that_are_started_by_the_tick_do_not_compete_with_it(clock: VirtualClock) -> None:
    found: list[int] = []

    def look() -> None:
        found.append(os.sched_getscheduler(0))

    with ThreadPoolExecutor() as before:
        before.submit(look).result()
        with upkeep(Realtime(priority=1, required=True), clock):
            before.submit(look).result()
            thread = threading.Thread(target=look)
            thread.start()
            thread.join()
            assert os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK == os.SCHED_FIFO
    assert found == [os.SCHED_OTHER] * 3


@pytest.mark.parametrize("priority", [50, 99, 1000])
def test_no_tick_goes_before_the_interrupts_that_it_waits_for(priority: int) -> None:
    assert Realtime(priority=HIGHEST_PRIORITY).priority == 49
    with pytest.raises(ValidationError, match=f"{priority} is above the bound, 49: interrupts may run at 50"):
        Realtime(priority=priority)


def test_memory_is_locked_for_the_future_too_and_unlocked_at_the_end(
    system: System, clock: VirtualClock
) -> None:
    with upkeep(Realtime(lock_memory=True), clock):
        assert system.said == ["lock 3"]
    assert system.said == ["lock 3", "unlock"]


def test_the_right_to_lock_memory_overrules_the_limit(system: System, clock: VirtualClock) -> None:
    system.limit, system.capabilities = 8 << 20, 1 << 14
    with upkeep(Realtime(lock_memory=True, required=True), clock):
        assert system.said == ["lock 3"]


def test_the_tick_runs_on_the_processors_that_were_chosen(system: System, clock: VirtualClock) -> None:
    with upkeep(Realtime(cpus=(1,)), clock):
        assert system.cpus == {1}
    assert system.cpus == {0, 1}


def _no_priority(system: System) -> Realtime:
    system.refuses = "priority"
    return Realtime(priority=49)


def _no_memory(system: System) -> Realtime:
    system.refuses = "memory"
    return Realtime(lock_memory=True)


def _a_limit(system: System) -> Realtime:
    system.limit = 8 << 20
    return Realtime(lock_memory=True)


REFUSALS = pytest.mark.parametrize(
    ("ask", "told"),
    [
        (
            _no_priority,
            "realtime.priority = 49 is refused: Operation not permitted. Under systemd, "
            "config/drop-ins/realtime.conf grants it, with LimitRTPRIO=49; elsewhere a limit 'rtprio' or ",
        ),
        (_no_memory, "realtime.lock_memory is refused: "),
        (
            _a_limit,
            "realtime.lock_memory is refused: this process may lock only 8 MiB. Under systemd, "
            "config/drop-ins/realtime.conf grants it, with LimitMEMLOCK=infinity; elsewhere CAP_IPC_LOCK",
        ),
        (
            lambda system: Realtime(cpus=(7,)),
            "realtime.cpus = [7] is refused: this process may run on [0, 1]; others do not exist",
        ),
        (lambda system: Realtime(cpus=(1, 7)), "realtime.cpus = [1, 7] is refused"),
    ],
)


@REFUSALS
def test_what_the_system_refuses_is_a_warning_that_says_what_would_grant_it(
    system: System,
    clock: VirtualClock,
    ask: Callable[[System], Realtime],
    told: str,
    caplog: pytest.LogCaptureFixture,
) -> None:
    with upkeep(ask(system), clock):
        assert [record.levelno for record in caplog.records] == [logging.WARNING]
        assert caplog.messages[0].startswith(told)
    assert (system.policy, system.cpus) == ((os.SCHED_OTHER, 0), {0, 1})


@REFUSALS
def test_what_the_system_refuses_is_the_end_if_it_is_required(
    system: System, clock: VirtualClock, ask: Callable[[System], Realtime], told: str
) -> None:
    wanted = ask(system).model_copy(update={"required": True})
    with pytest.raises(ConfigError, match=re.escape(told)) as refused, upkeep(wanted, clock):
        raise AssertionError("it was entered")
    assert refused.value.field.startswith("realtime.")
    assert (system.policy, system.cpus) == ((os.SCHED_OTHER, 0), {0, 1})


def test_a_limit_up_to_which_memory_can_be_locked_is_not_used(system: System, clock: VirtualClock) -> None:
    with upkeep(_a_limit(system), clock):
        assert system.said == []


def test_garbage_is_collected_in_the_slack_or_left_to_python(clock: VirtualClock) -> None:
    with upkeep(Realtime(gc="slack"), clock) as around:
        assert isinstance(around.collector, SlackCollector)
        assert gc.isenabled()  # until everything is built
    with upkeep(NOTHING, clock) as around:
        assert not isinstance(around.collector, SlackCollector)


def test_nothing_is_left_of_it_afterwards(clock: VirtualClock) -> None:
    def settings() -> tuple[object, ...]:
        alarm = signal.getsignal(signal.SIGALRM)
        locked = [line for line in Path("/proc/self/status").read_text().splitlines() if "VmLck" in line]
        policy = os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK  # that stays, without CAP_SYS_NICE
        return alarm, policy, os.sched_getaffinity(0), locked, gc.isenabled(), len(gc.callbacks)

    before = settings()
    wanted = Realtime(priority=1, cpus=(min(os.sched_getaffinity(0)),), lock_memory=False)
    with upkeep(wanted, clock) as around, around.collector:
        assert settings() != before
    assert settings() == before
