import os
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from bentod.supervise import Supervisor


class Systemd:
    """The other end of the notification socket."""

    def __init__(self, address: str) -> None:
        self.address = address
        self.socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self.socket.setblocking(False)
        self.socket.bind(f"\0{address[1:]}" if address.startswith("@") else address)

    def heard(self) -> list[str]:
        messages = []
        while True:
            try:
                messages.append(self.socket.recv(4096).decode())
            except BlockingIOError:
                return messages


@pytest.fixture(params=["path", "abstract"])
def systemd(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Systemd]:
    path = tmp_path / "notify"
    found = Systemd(f"@bentod-test{path}" if request.param == "abstract" else str(path))
    with found.socket:
        yield found


def environment(systemd: Systemd, **more: str) -> dict[str, str]:
    return {"NOTIFY_SOCKET": systemd.address, **more}


def test_readiness_status_and_the_end_are_told_in_order(systemd: Systemd) -> None:
    with Supervisor.from_environment(environment(systemd)) as supervisor:
        supervisor.ready()
        supervisor.status("holding")
        supervisor.stopping()
    assert systemd.heard() == ["READY=1", "STATUS=holding", "STOPPING=1"]


def test_a_status_is_one_line_and_cannot_feed_the_watchdog(systemd: Systemd) -> None:
    with Supervisor.from_environment(environment(systemd)) as supervisor:
        supervisor.status("fault:\nWATCHDOG=1")
    assert systemd.heard() == ["STATUS=fault: WATCHDOG=1"]


def test_ticks_feed_the_watchdog_at_most_twice_in_its_time(systemd: Systemd) -> None:
    with Supervisor.from_environment(environment(systemd, WATCHDOG_USEC="2000000")) as supervisor:
        pings = []
        for tick in range(91):
            supervisor.tick(tick / 30)
            pings += [tick] * len(systemd.heard())
    assert pings == [0, 30, 60, 90]


def test_a_tick_that_is_stuck_feeds_nothing(systemd: Systemd) -> None:
    with Supervisor.from_environment(environment(systemd, WATCHDOG_USEC="2000000")) as supervisor:
        supervisor.tick(0.0)
        supervisor.status("still here")
    assert systemd.heard() == ["WATCHDOG=1", "STATUS=still here"]


@pytest.mark.parametrize(
    "more",
    [{}, {"WATCHDOG_USEC": "soon"}, {"WATCHDOG_USEC": "0"}, {"WATCHDOG_USEC": "10", "WATCHDOG_PID": "1"}],
)
def test_without_a_watchdog_of_its_own_a_tick_says_nothing(systemd: Systemd, more: dict[str, str]) -> None:
    with Supervisor.from_environment(environment(systemd, **more)) as supervisor:
        supervisor.tick(0.0)
    assert systemd.heard() == []


def test_a_watchdog_that_names_this_process_is_fed(systemd: Systemd) -> None:
    more = {"WATCHDOG_USEC": "10", "WATCHDOG_PID": str(os.getpid())}
    with Supervisor.from_environment(environment(systemd, **more)) as supervisor:
        supervisor.tick(0.0)
    assert systemd.heard() == ["WATCHDOG=1"]


@pytest.mark.parametrize("address", ["", "relative/path", "vsock:2:1234"])
def test_without_a_socket_of_this_machine_every_word_is_silence(address: str) -> None:
    with Supervisor.from_environment({"NOTIFY_SOCKET": address, "WATCHDOG_USEC": "10"}) as supervisor:
        supervisor.ready()
        supervisor.tick(0.0)


def test_a_supervisor_that_is_gone_disturbs_nobody(tmp_path: Path) -> None:
    gone = {"NOTIFY_SOCKET": str(tmp_path / "gone"), "WATCHDOG_USEC": "10"}
    with Supervisor.from_environment(gone) as supervisor:
        supervisor.ready()
        supervisor.tick(0.0)
        supervisor.stopping()
    supervisor.status("closed")


def test_a_supervisor_that_does_not_listen_is_not_waited_for(systemd: Systemd) -> None:
    with Supervisor.from_environment(environment(systemd, WATCHDOG_USEC="10")) as supervisor:
        for _ in range(2000):
            supervisor.status("x" * 200)
        assert 0 < len(systemd.heard()) < 2000
        supervisor.tick(0.0)
    assert systemd.heard() == ["WATCHDOG=1"]
