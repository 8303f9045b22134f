"""A multicast bus of this machine alone, for tests that need one to themselves."""

import socket
from functools import cache

import can

GROUP = "239.74.163.2"
"""python-can's own."""


@cache
def multicast() -> str:
    """Why no multicast comes back on this machine; empty when it does."""
    try:
        with can.Bus(interface="udp_multicast", channel=GROUP, port=free_port(), hop_limit=0) as bus:
            bus.send(can.Message(arbitration_id=1, is_extended_id=False))
            return "" if bus.recv(0.5) else "a multicast packet did not come back"
    except (can.CanError, OSError) as error:
        return str(error)


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("", 0))
        port: int = probe.getsockname()[1]
        return port
