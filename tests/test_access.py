"""A whole daemon, and who may do what with its arm."""

import os
import socket as sockets
from pathlib import Path

import pytest

from bentod.cli.check import explain
from bentod.client import Client
from bentod.config_tables import Access
from bentod.endpoint import RpcError
from bentod.furnish import mind_of
from bentod.hosts import LOOPBACK
from tests.rig import PLAIN, joint, number, quiet_config, running, state, wait_for
from tests.serve.doors import OBSERVER, OPERATOR, TLS, Files


@pytest.fixture
def socket(tmp_path: Path) -> Path:
    return tmp_path / "bentod.sock"


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path)


def free_port() -> int:
    """A port that nobody listens on now."""
    with sockets.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


async def test_over_tls_an_operator_moves_the_arm_and_an_observer_looks_and_stops_it(
    socket: Path, files: Files
) -> None:
    port = free_port()
    tcp = files.with_tls().model_copy(update={"port": port})
    config = quiet_config(PLAIN).model_copy(update={"tcp": tcp})
    where, authority = f"tls://127.0.0.1:{port}", TLS / "certificate.pem"
    async with (
        running(config, socket) as near,
        Client.connect(where, OPERATOR, authority) as operator,
        Client.connect(where, OBSERVER, authority) as observer,
    ):
        await operator.call("move", joint="gripper", velocity=0.3, lease_s=2.0)
        await wait_for(near, lambda f: number(joint(f, "gripper"), "velocity") > 0.2)
        for method in ("move", "torque", "pause", "go_home", "clear_fault", "inject", "set_meta"):
            with pytest.raises(RpcError, match=f"{method} needs the role operator"):
                await observer.call(method)
        assert number(joint(await state(observer), "gripper"), "velocity") > 0.2
        clients = await near.call("list_clients")
        assert isinstance(clients, list)
        assert [(c["role"], c["user"]) for c in clients if isinstance(c, dict)] == [
            ("operator", f"uid {os.getuid()}"),
            ("operator", LOOPBACK),
            ("observer", LOOPBACK),
        ]
        await observer.call("stop")
        assert (await state(near))["mode"] == "paused"


async def test_what_an_operator_held_over_tcp_ends_with_its_connection(socket: Path, files: Files) -> None:
    port = free_port()
    config = quiet_config(PLAIN).model_copy(update={"tcp": files.tcp().model_copy(update={"port": port})})
    async with running(config, socket) as near:
        async with Client.connect(f"tcp://127.0.0.1:{port}", OPERATOR) as operator:
            await operator.call("move", joint="gripper", velocity=0.3, lease_s=2.0)
            await wait_for(near, lambda f: number(joint(f, "gripper"), "velocity") > 0.2)
        await wait_for(near, lambda f: joint(f, "gripper")["holder"] == "", 0.2)


async def test_the_configs_limits_hold_for_the_daemons_clients(socket: Path) -> None:
    access = Access(requests_per_s=50)
    async with running(quiet_config(PLAIN).model_copy(update={"access": access}), socket) as arm:
        before = number(await state(arm), "time")
        for _ in range(200):
            await arm.call("get_info")
        assert number(await state(arm), "time") - before > 2.5


def test_a_config_explains_who_may_do_what(files: Files) -> None:
    access = Access(operators=("dialout",), observers=("students",))
    config = quiet_config().model_copy(update={"access": access, "tcp": files.tcp()})
    told = "\n".join(explain(config, mind_of(config)))
    assert "It may be moved by the daemon's own user, root, the group dialout;" in told
    assert "looked at, and stopped, by the group students." in told
    assert "Over TCP, from this machine only: 127.0.0.1 port 0, for whoever has a token." in told
