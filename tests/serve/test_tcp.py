"""Over TCP nobody comes in without a token, and nobody who tries takes anything from those who have one."""

import asyncio
import base64
import contextlib
import logging
import socket
import ssl
from pathlib import Path

import pytest

from bentod.address import TOKEN_VARIABLE
from bentod.blocking import BlockingClient
from bentod.client import Client
from bentod.config_tables import Tcp
from bentod.endpoint import Disconnected, RpcError
from bentod.errors import BadRequest, BentodError, ConfigError
from bentod.frames import Value
from bentod.hosts import LOOPBACK, network
from bentod.messages import Response, encode_notification, encode_request, encode_result
from bentod.serve import tcp_door
from bentod.serve.attempts import MOST_ADDRESSES, Attempts
from bentod.serve.peers import Role
from bentod.serve.server import Server
from bentod.serve.session import Bounds
from bentod.serve.tcp_door import CLEAR, HOW, WAITING, WAITING_EACH, TcpDoor
from bentod.serve.tcp_listener import HANDSHAKES_PER_S, handshakes_per_s, server_tls
from bentod.token_file import proof
from tests.serve.doors import OBSERVER, OPERATOR, TLS, Files, dialled, prove, said, strict
from tests.serve.helpers import frame


@pytest.fixture
def files(tmp_path: Path) -> Files:
    return Files(tmp_path)


@pytest.fixture
def server(files: Files) -> Server:
    return strict(files.folder / "bentod.sock", tcp=files.tcp())


@pytest.fixture
def secure(files: Files) -> Server:
    return strict(files.folder / "bentod.sock", tcp=files.with_tls())


def at(server: Server, scheme: str = "tcp") -> str:
    return f"{scheme}://127.0.0.1:{server.addresses[0][1]}"


@pytest.mark.parametrize(("token", "answer"), [(OPERATOR, "moved"), (OBSERVER, "needs the role operator")])
async def test_a_token_gives_its_role(server: Server, token: str, answer: str) -> None:
    async with server, dialled(server) as plug:
        await prove(plug, token)
        plug.ask(2, "move")  # may follow at once
        role = "operator" if token == OPERATOR else "observer"
        assert await plug.next() == Response(1, None, {"role": role})
        assert answer in await said(plug)


@pytest.mark.parametrize(
    "params", [[OPERATOR], {"token": OPERATOR}, [{"token": OPERATOR}]], ids=["list", "map", "map in a list"]
)
async def test_over_tls_the_token_itself_will_do(secure: Server, params: Value) -> None:
    async with secure, dialled(secure, tls=True) as plug:
        plug.writer.write(encode_request(1, "authenticate", params))
        assert await said(plug) == "{'role': 'operator'}"


@pytest.mark.parametrize("token", ["", OPERATOR[:-1], OPERATOR + "x", OBSERVER[:10], "ü" * 40])
async def test_a_wrong_token_is_refused_without_a_word_of_it(
    server: Server, token: str, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.DEBUG)
    async with server, dialled(server) as plug:
        await prove(plug, token)
        assert await said(plug) == "The token is wrong."
        assert await plug.next() is None
        assert server.sessions == ()
    assert "The token is wrong" in caplog.text
    assert not token or token not in caplog.text


async def test_no_token_is_ever_logged(secure: Server, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.DEBUG)
    async with secure as server, dialled(secure, tls=True) as plug:
        plug.ask(1, "authenticate", OPERATOR)
        await plug.next()
        plug.ask(2, "authenticate", OPERATOR)
        await plug.next()
    assert "has the operator's token" in caplog.text
    assert OPERATOR not in caplog.text
    assert OPERATOR not in repr(vars(server))


@pytest.mark.parametrize(
    "first",
    [
        encode_request(1, "stop", []),
        encode_request(1, "list_methods", []),
        encode_request(1, "double", [4]),
        encode_notification("authenticate", [OPERATOR]),
        b"\x94\x01\x01\xc0\xc0",
    ],
    ids=["stop", "list_methods", "double", "notification", "response"],
)
async def test_before_the_token_nothing_is_answered_but_how_to_give_it(server: Server, first: bytes) -> None:
    async with server, dialled(server) as plug:
        plug.writer.write(first)
        assert await said(plug) == HOW
        assert await plug.next() is None


@pytest.mark.parametrize(
    "params", [[], None, 5, [5], [OPERATOR, 1], {"tok": OPERATOR}, [[OPERATOR]], [OPERATOR.encode()]]
)
async def test_a_token_of_another_shape_is_not_echoed(server: Server, params: Value) -> None:
    async with server, dialled(server) as plug:
        plug.writer.write(encode_request(1, "authenticate", params))
        assert await said(plug) == (
            "authenticate takes proof, a text, after a challenge; or with TLS token, a text."
        )
        assert await plug.next() is None


@pytest.mark.parametrize(
    ("hostile", "words"),
    [
        (b"GET / HTTP/1.1\r\n\r\n", "A message is an array"),
        (b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03", "A message is an array"),
        (b"\xdd\xff\xff\xff\xff", "more than 16 values"),
        (b"\xdb\xff\xff\xff\xff", "longer than 2048 bytes"),
        (b"\x91" * 100, "nested more than 4"),
        (b"\xc1", "0xc1"),
        (b"\x94\x00\x01\xacauthenticate\x91\xd9\xff\xff", ""),
    ],
    ids=["http", "tls", "values", "text", "nesting", "never used", "cut off"],
)
async def test_hostile_bytes_at_the_door_are_answered_and_end_there(
    server: Server, hostile: bytes, words: str
) -> None:
    async with server, dialled(server) as plug:
        plug.writer.write(hostile)
        assert words in await said(plug)
        assert await plug.next() is None
        assert server.sessions == ()


@pytest.mark.parametrize("dribble", [b"", b"\x94", b"\x94\x00\x01\xacauth"])
async def test_who_does_not_say_who_it_is_within_5_s_is_sent_away(server: Server, dribble: bytes) -> None:
    loop = asyncio.get_running_loop()
    async with server, dialled(server) as plug:
        plug.writer.write(dribble)
        assert await said(plug) == HOW
        assert 4.9 < loop.time() < 5.2
        assert await plug.next() is None


async def test_a_token_that_drips_in_is_too_late(server: Server) -> None:
    async with server, dialled(server) as plug:
        for byte in encode_request(1, "authenticate", [OPERATOR])[:10]:
            plug.writer.write(bytes([byte]))
            await asyncio.sleep(0.49)
        assert await said(plug) == HOW
        assert server.sessions == ()


@pytest.mark.parametrize(("apart", "stay"), [(False, WAITING_EACH), (True, WAITING)])
async def test_who_has_waited_longest_at_the_door_makes_way_for_whoever_comes(
    server: Server, monkeypatch: pytest.MonkeyPatch, apart: bool, stay: int
) -> None:
    if apart:
        monkeypatch.setattr(tcp_door, "network", lambda host: host)
    async with server, contextlib.AsyncExitStack() as stack:
        silent = []
        for n in range(WAITING + 2):
            source = (f"127.0.0.{2 + n}", 0)
            silent.append(await stack.enter_async_context(dialled(server, source=source)))
            await asyncio.sleep(0.06)  # as many come as are taken
        async with Client.connect(at(server), token=OPERATOR) as arm:
            assert await arm.call("move") == "moved"
        await asyncio.sleep(0.1)
        left = [plug.has_ended for plug in silent]
        assert left == [True] * (WAITING + 3 - stay) + [False] * (stay - 1)


async def test_guessing_gets_slower_and_who_knows_the_token_does_not_wait(server: Server) -> None:
    loop = asyncio.get_running_loop()
    took = []
    async with server:
        for _ in range(7):
            begin = loop.time()
            async with dialled(server) as plug:
                await prove(plug, "guess" * 8)
                assert await said(plug) == "The token is wrong."
            took.append(round(loop.time() - begin, 1))
        begin = loop.time()
        async with Client.connect(at(server), token=OPERATOR):
            assert loop.time() - begin < 0.1
    assert took == [0.0, 0.0, 0.5, 1.0, 2.0, 4.0, 5.0]


async def test_a_proof_is_good_for_one_connection_only(server: Server) -> None:
    async with server:
        async with dialled(server) as plug:
            plug.ask(1, "challenge")
            match await plug.next():
                case Response(result={"nonce": str(nonce)}):
                    heard = {"proof": proof(OPERATOR, nonce)}
        async with dialled(server) as plug:
            plug.ask(1, "challenge")
            await plug.next()
            plug.writer.write(encode_request(2, "authenticate", heard))
            assert await said(plug) == "The token is wrong."


async def test_without_tls_a_token_in_the_clear_is_refused_even_if_it_is_right(server: Server) -> None:
    async with server, dialled(server) as plug:
        plug.ask(1, "authenticate", OPERATOR)
        assert await said(plug) == CLEAR
        assert await plug.next() is None


@pytest.mark.real_time
@pytest.mark.parametrize("blocking", [False, True])
async def test_whoever_listens_in_the_daemons_place_does_not_learn_the_token(blocking: bool) -> None:
    heard = bytearray()

    async def use(address: str) -> None:
        async with Client.connect(address, token=OPERATOR):
            pass

    async def pose(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        heard.extend(await reader.read(1000))
        writer.write(encode_result(0, {"nonce": "0" * 64}))
        heard.extend(await reader.read(1000))
        writer.close()

    server = await asyncio.start_server(pose, "127.0.0.1", 0)
    address = f"tcp://127.0.0.1:{server.sockets[0].getsockname()[1]}"
    with pytest.raises(BentodError):
        await (asyncio.to_thread(BlockingClient, address, 5.0, OPERATOR) if blocking else use(address))
    server.close()
    assert b"proof" in heard
    assert OPERATOR.encode() not in heard


def test_failures_of_many_addresses_slow_all_of_them_and_are_forgotten() -> None:
    now = 0.0
    attempts = Attempts(lambda: now)
    waits = [attempts.failed(f"10.0.{n >> 8}.{n & 255}") for n in range(3 * MOST_ADDRESSES)]
    assert waits[:22] == [0.0] * 20 + [0.1, 0.2]
    assert waits[-1] == 2.0
    assert len(attempts._addresses) == MOST_ADDRESSES
    now = 601.0
    assert attempts.failed("10.0.0.1") == 0.0


def test_an_address_that_got_in_starts_anew() -> None:
    attempts = Attempts(lambda: 0.0)
    assert [attempts.failed("a") for _ in range(4)] == [0.0, 0.0, 0.5, 1.0]
    attempts.succeeded("a")
    assert attempts.failed("a") == 0.0


def test_a_whole_network_of_ipv6_counts_as_one() -> None:
    assert network("2001:db8:1:2:3::4") == network("2001:db8:1:2:ffff::1") == "2001:db8:1:2::/64"
    assert network("fe80::1%eth0") == "fe80::/64"
    assert network("::ffff:10.0.0.7") == network("10.0.0.7") == "10.0.0.7"


def test_all_of_this_machines_own_addresses_count_as_one() -> None:
    assert {network(host) for host in ("127.0.0.1", "127.9.9.9", "::1", "::ffff:127.0.0.2")} == {LOOPBACK}


async def test_connections_are_taken_at_a_bounded_pace(server: Server) -> None:
    loop = asyncio.get_running_loop()
    async with server:
        for _ in range(48):
            async with dialled(server) as plug:
                plug.ask(1, "stop")
                assert await said(plug) == HOW
        assert 1.8 < loop.time() < 2.2  # 8 at once, then 20 a second


async def test_one_address_takes_no_more_than_its_share(files: Files) -> None:
    path = files.folder / "bentod.sock"
    server = strict(path, tcp=files.tcp(), bounds=Bounds(per_user=1))
    async with server, Client.connect(at(server), token=OPERATOR) as arm:
        async with dialled(server) as plug:
            await prove(plug, OPERATOR)
            assert await said(plug) == "{'role': 'operator'}"
            assert "127.0.0.0/8 has 1 connections; no more fit" in await said(plug)
        assert await arm.call("move") == "moved"


async def test_both_ways_in_lead_to_the_same_server(server: Server) -> None:
    async with server, Client.connect(server.path) as near, Client.connect(at(server), token=OPERATOR) as far:
        assert await near.call("double", 1) == await far.call("double", 1) == 2
        assert {session.peer.role for session in server.sessions} == {Role.OPERATOR, Role.OBSERVER}
        assert [session.peer.user for session in server.sessions][1] == LOOPBACK


async def test_tls_clients_come_in(secure: Server) -> None:
    async with secure:
        address = at(secure, "tls")
        async with Client.connect(address, token=OPERATOR, cafile=TLS / "certificate.pem") as arm:
            assert await arm.call("move") == "moved"
            async with arm.listen("events"):
                pass


async def test_tls_1_2_will_do_and_nothing_older(secure: Server, files: Files) -> None:
    context = server_tls(files.with_tls())
    assert context is not None
    assert context.minimum_version is ssl.TLSVersion.TLSv1_2
    async with secure:
        older = ssl.create_default_context(cafile=TLS / "certificate.pem")
        older.maximum_version = ssl.TLSVersion.TLSv1_2
        reader, writer = await asyncio.open_connection(*secure.addresses[0], ssl=older)
        writer.write(encode_request(1, "authenticate", [OPERATOR]))
        assert b"operator" in await reader.read(100)
        writer.transport.abort()


async def test_a_server_that_cannot_prove_who_it_is_gets_no_token(secure: Server) -> None:
    async with secure:
        with pytest.raises(Disconnected, match=r"cannot prove who it is: .*BENTOD_CA_FILE"):
            async with Client.connect(at(secure, "tls"), token=OPERATOR):
                pass


async def test_a_client_without_tls_is_not_listened_to_by_a_server_with_it(secure: Server) -> None:
    async with secure:
        reader, writer = await asyncio.open_connection(*secure.addresses[0])
        writer.write(encode_request(1, "authenticate", [OPERATOR]))
        heard = b""
        with contextlib.suppress(ConnectionError):
            heard = await reader.read()
        assert heard[:1] in (b"", b"\x15")  # nothing, or an alert of TLS
        assert secure.sessions == ()
        writer.close()


async def test_a_client_that_is_slow_at_tls_is_let_go(secure: Server) -> None:
    async with secure:
        reader, writer = await asyncio.open_connection(*secure.addresses[0])
        writer.write(b"\x16\x03\x01")
        assert await reader.read() == b""
        assert 4.9 < asyncio.get_running_loop().time() < 6.2
        writer.close()


async def test_the_server_ends_while_clients_stand_at_the_door(secure: Server) -> None:
    async with secure:
        silent = [await asyncio.open_connection(*secure.addresses[0]) for _ in range(3)]
        await asyncio.sleep(0.1)
    for reader, writer in silent:
        with contextlib.suppress(ConnectionError):
            assert await reader.read() == b""
        writer.close()


async def test_a_stuck_client_over_tls_is_dropped(files: Files, caplog: pytest.LogCaptureFixture) -> None:
    path = files.folder / "bentod.sock"
    server = strict(path, tcp=files.with_tls(), bounds=Bounds(unsent=4096, stuck=2.0))
    async with server, dialled(server, tls=True) as plug:
        plug.ask(1, "authenticate", OPERATOR)
        plug.ask(2, "subscribe", "state", 30)
        await plug.next()
        plug.writer.transport.pause_reading()  # type: ignore[attr-defined]
        for tick in range(900):
            server.publish_state(frame(tick, meta="x" * 20_000))
            await asyncio.sleep(1 / 30)
        assert server.sessions == ()
    assert "it has not read for 2 s" in caplog.text


async def test_a_wrong_token_is_a_clear_error_for_a_client(server: Server) -> None:
    async with server:
        with pytest.raises(RpcError, match="The token is wrong"):
            async with Client.connect(at(server), token="x" * 32):
                pass


async def test_a_client_finds_its_token_in_the_file_that_the_environment_names(
    server: Server, files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    async with server:
        with pytest.raises(ConfigError, match="name its file in BENTOD_TOKEN_FILE"):
            async with Client.connect(at(server)):
                pass
        monkeypatch.setenv(TOKEN_VARIABLE, str(files.folder / "operator"))
        async with Client.connect(at(server)) as arm:
            assert await arm.call("move") == "moved"


@pytest.mark.real_time
@pytest.mark.parametrize("tls", [False, True])
async def test_the_blocking_client_comes_in_over_tcp(files: Files, tls: bool) -> None:
    def use() -> Value:
        with BlockingClient(address, token=OPERATOR, cafile=TLS / "certificate.pem") as arm:
            arm.call("subscribe", topic="events")
            return arm.call("move")

    async with strict(files.folder / "s", tcp=files.with_tls() if tls else files.tcp()) as server:
        address = at(server, "tls" if tls else "tcp")
        assert await asyncio.to_thread(use) == "moved"
        with pytest.raises(RpcError, match="The token is wrong"):
            await asyncio.to_thread(BlockingClient, address, 5.0, "x" * 32, TLS / "certificate.pem")


async def test_a_dead_peer_is_noticed_by_the_kernel(server: Server) -> None:
    async with server, Client.connect(at(server), token=OPERATOR):
        (session,) = server.sessions
        found: socket.socket = session._writer.get_extra_info("socket")
        assert found.getsockopt(socket.SOL_SOCKET, socket.SO_KEEPALIVE)
        assert found.getsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT) == 15_000


async def test_a_port_that_is_taken_is_a_config_error_and_leaves_nothing_behind(files: Files) -> None:
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        tcp = files.tcp().model_copy(update={"port": other.getsockname()[1]})
        with pytest.raises(ConfigError, match="cannot listen on"):
            await strict(files.folder / "s", tcp=tcp).__aenter__()
    assert not (files.folder / "s").exists()


async def test_a_name_that_leads_elsewhere_is_not_served_without_tls(
    files: Files, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = [(socket.AF_INET, socket.SOCK_STREAM, 6, "", ("192.0.2.1", 0))]
    monkeypatch.setattr(socket, "getaddrinfo", lambda *_, **__: elsewhere)
    with pytest.raises(ConfigError, match=r"is 192\.0\.2\.1, which others can reach"):
        await strict(files.folder / "s", tcp=files.tcp(host="localhost")).__aenter__()


async def test_the_two_tokens_must_differ(files: Files) -> None:
    tcp = files.tcp()
    files.secret("observer", OPERATOR)
    with pytest.raises(ConfigError, match="hold the same token"):
        TcpDoor(tcp)


@pytest.mark.parametrize(
    ("name", "mode", "words"),
    [
        ("key.pem", 0o644, "everybody can read it"),
        ("locked_key.pem", 0o600, "is encrypted"),
        ("certificate.pem", 0o600, "no TLS with it"),
        ("missing", None, "cannot be read"),
    ],
)
async def test_a_key_that_will_not_do_is_a_config_error(
    files: Files, name: str, mode: int | None, words: str
) -> None:
    key = files.folder / name
    if mode is not None:
        key.write_bytes((TLS / name).read_bytes())
        key.chmod(mode)
    with pytest.raises(ConfigError, match=words):
        TcpDoor(files.tcp(certificate=TLS / "certificate.pem", key=key))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"host": "0.0.0.0"}, "can be reached by others, and so needs TLS"),  # noqa: S104 - to be refused
        ({"host": "arm.lab"}, "can be reached by others, and so needs TLS"),
        ({"host": "::"}, "can be reached by others, and so needs TLS"),
        ({"certificate": "c"}, "certificate and key go together"),
        ({"host": "0.0.0.0", "key": "k"}, "certificate and key go together"),  # noqa: S104
        ({"operator_token": None, "observer_token": None}, "needs operator_token, observer_token or both"),
        ({"port": 0}, "greater than or equal to 1"),
    ],
)
def test_a_table_that_would_let_strangers_in_is_refused(
    files: Files, changes: dict[str, object], words: str
) -> None:
    with pytest.raises(ValueError, match=words):
        files.tcp(**changes)


@pytest.mark.parametrize("host", ["127.0.0.1", "127.8.8.8", "::1", "localhost"])
def test_this_machine_alone_needs_no_tls(files: Files, host: str) -> None:
    assert files.tcp(host=host).certificate is None


def test_without_the_table_there_is_no_tcp() -> None:
    with pytest.raises(ValueError, match="needs operator_token"):
        Tcp()


async def test_a_client_refuses_to_send_a_token_in_the_clear() -> None:
    with pytest.raises(BadRequest, match=r"in the clear; use tls://arm\.lab:4776"):
        async with Client.connect("tcp://arm.lab:4776", token=OPERATOR):
            pass


@pytest.mark.parametrize(("size", "slow"), [(1218, False), (1794, False), (2375, True), (4700, True)])
def test_a_key_that_takes_long_to_sign_with_is_told_and_used_seldom(
    files: Files, caplog: pytest.LogCaptureFixture, size: int, slow: bool
) -> None:
    text = base64.encodebytes(bytes(size)).decode()
    key = files.secret("key.pem", f"-----BEGIN PRIVATE KEY-----\n{text}-----END PRIVATE KEY-----\n")
    tcp = files.tcp(certificate=TLS / "certificate.pem", key=key)
    assert (handshakes_per_s(tcp) < HANDSHAKES_PER_S) is slow
    assert ("longer than RSA with 3072 bits" in caplog.text) is slow
