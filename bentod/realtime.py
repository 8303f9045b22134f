"""What the process asks of the operating system, to be on time; all of it is given back at the end."""

import ctypes
import logging
import os
import resource
from collections.abc import Iterator
from contextlib import AbstractContextManager, ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path

from bentod.collector import Collector, SlackCollector
from bentod.config_tables import Realtime
from bentod.contracts import Clock
from bentod.culprit import AlarmLookout, Lookout
from bentod.errors import ConfigError
from bentod.gate import Gate

_log = logging.getLogger(__name__)

_MCL_CURRENT, _MCL_FUTURE = 1, 2  # bits/mman-linux.h
_CAP_IPC_LOCK = 14  # linux/capability.h
_STATUS = Path("/proc/self/status")


DROP_IN = "Under systemd, config/drop-ins/realtime.conf grants it"


@dataclass(frozen=True, slots=True)
class Upkeep:
    """What goes on around the ticks of a process. By default nothing: a process can have many daemons."""

    collector: Collector = field(default_factory=Collector)
    lookout: Lookout = field(default_factory=Lookout)
    gate: Gate = field(default_factory=Gate)


@contextmanager
def upkeep(wanted: Realtime, clock: Clock) -> Iterator[Upkeep]:
    """While entered, the process has what `wanted` asks for; what the system refuses is a warning.

    For the main thread of a process that has one daemon.

    Raises:
        ConfigError: it is refused, and `required`.
    """
    with ExitStack() as stack:
        for ask in (_scheduling, _memory, _processors):
            _enter(stack, ask(wanted), wanted.required)
        lookout = stack.enter_context(AlarmLookout())
        yield Upkeep(SlackCollector(clock) if wanted.gc == "slack" else Collector(), lookout)


def _enter(stack: ExitStack, asked: AbstractContextManager[None], required: bool) -> None:
    try:
        stack.enter_context(asked)
    except ConfigError as error:
        if required:
            raise
        _log.warning("%s", error)


@contextmanager
def _scheduling(wanted: Realtime) -> Iterator[None]:
    """SCHED_FIFO for the thread of the tick alone: it must not compete with its own helpers."""
    if wanted.priority == 0:
        yield
        return
    policy, parameter = os.sched_getscheduler(0), os.sched_getparam(0)
    chosen = os.sched_param(wanted.priority)
    try:
        os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, chosen)
    except OSError as error:
        raise ConfigError(
            f"realtime.priority = {wanted.priority} is refused: {error.strerror}. {DROP_IN}, with "
            f"LimitRTPRIO={wanted.priority}; elsewhere a limit 'rtprio' or CAP_SYS_NICE does.",
            "realtime.priority",
        ) from error
    try:
        yield
    finally:
        with suppress(OSError):  # a process without CAP_SYS_NICE may not take RESET_ON_FORK back
            os.sched_setscheduler(0, policy | os.SCHED_RESET_ON_FORK, parameter)
            os.sched_setscheduler(0, policy, parameter)


@contextmanager
def _memory(wanted: Realtime) -> Iterator[None]:
    """All memory stays in RAM, also what is allocated later."""
    if not wanted.lock_memory:
        yield
        return
    _lock_memory()
    try:
        yield
    finally:
        ctypes.CDLL(None).munlockall()


def _lock_memory() -> None:
    limit, _ = resource.getrlimit(resource.RLIMIT_MEMLOCK)
    remedy = f"{DROP_IN}, with LimitMEMLOCK=infinity; elsewhere CAP_IPC_LOCK does."
    if limit != resource.RLIM_INFINITY and not _may_lock_everything():
        # Locked up to a limit, the process would get no more memory at all beyond it.
        raise ConfigError(
            f"realtime.lock_memory is refused: this process may lock only {limit / 2**20:g} MiB. {remedy}",
            "realtime.lock_memory",
        )
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.mlockall(_MCL_CURRENT | _MCL_FUTURE) != 0:
        why = os.strerror(ctypes.get_errno())
        raise ConfigError(f"realtime.lock_memory is refused: {why}. {remedy}", "realtime.lock_memory")


def _may_lock_everything() -> bool:
    """Whether the process has CAP_IPC_LOCK."""
    lines = _STATUS.read_text().splitlines() if _STATUS.exists() else []
    effective = next((int(line.split()[1], 16) for line in lines if line.startswith("CapEff:")), 0)
    return bool(effective >> _CAP_IPC_LOCK & 1)


@contextmanager
def _processors(wanted: Realtime) -> Iterator[None]:
    """The thread of the tick runs on the chosen processors only, and so do those that it starts."""
    if not wanted.cpus:
        yield
        return
    before, chosen = os.sched_getaffinity(0), set(wanted.cpus)
    try:
        with suppress(OSError):  # none of them
            os.sched_setaffinity(0, chosen)
        granted = os.sched_getaffinity(0)
        if granted != chosen:  # some of them
            raise ConfigError(
                f"realtime.cpus = {sorted(chosen)} is refused: this process may run on "
                f"{sorted(before | granted)}; others do not exist, or it is kept from them. {DROP_IN}.",
                "realtime.cpus",
            )
        yield
    finally:
        os.sched_setaffinity(0, before)
