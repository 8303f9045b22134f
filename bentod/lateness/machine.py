"""The machine that something was measured on: what it is, and what its host takes from it."""

import os
import platform
from pathlib import Path

from bentod.config_tables import Realtime

_STAT, _STEAL = Path("/proc/stat"), 8  # the file's word for it is the ninth, man proc_stat
_CPU = Path("/proc/cpuinfo")
_POLICIES = {"SCHED_OTHER": "normal", "SCHED_FIFO": "FIFO", "SCHED_RR": "round robin"}


def stolen() -> float:
    """CPU time (s) that the host of this virtual machine gave to others; 0 where nobody counts it."""
    if not _STAT.exists():
        return 0.0
    return int(_STAT.read_text().split()[_STEAL]) / os.sysconf("SC_CLK_TCK")


def described() -> dict[str, str | int]:
    """Kernel, Python and processor."""
    return {
        "kernel": f"{platform.system()} {platform.release()} {platform.version()}",
        "python": platform.python_version(),
        "cpu": _model(),
        "cores": os.cpu_count() or 1,
    }


def scheduling(realtime: Realtime) -> str:
    """How a process that was granted `realtime` is scheduled, and where, in words."""
    if not hasattr(os, "sched_getscheduler"):
        return "as the system does"
    policy = os.SCHED_FIFO if realtime.priority else os.sched_getscheduler(0) & ~os.SCHED_RESET_ON_FORK
    priority = realtime.priority or os.sched_getparam(0).sched_priority
    names = {getattr(os, name): word for name, word in _POLICIES.items()}
    cores = ", ".join(map(str, sorted(realtime.cpus or os.sched_getaffinity(0))))
    return f"{names.get(policy, 'another class')}{f' {priority}' if priority else ''}, on core {cores}"


def _model() -> str:
    lines = _CPU.read_text().splitlines() if _CPU.exists() else []
    return next((line.partition(":")[2].strip() for line in lines if line.startswith("model name")), "") or (
        platform.processor() or platform.machine()
    )
