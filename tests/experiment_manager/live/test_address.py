"""What --live is given: hosts, ports, both, and what is neither."""

import argparse
import socket

import pytest

from active_binocular_vision.commands.run import main
from experiment_manager.live.address import Address
from experiment_manager.live.server import ViewServer
from lockstep import InputError


@pytest.mark.parametrize(
    ("text", "host", "port"),
    [
        ("lab", "lab", 8765),
        ("0.0.0.0:9000", "0.0.0.0", 9000),
        ("127.1:9001", "127.1", 9001),
        (":9000", "127.0.0.1", 9000),
        ("9000", "127.0.0.1", 9000),
        ("::1", "::1", 8765),
        ("fe80::1:2", "fe80::1:2", 8765),
        ("[::1]", "::1", 8765),
        ("[::1]:9000", "::1", 9000),
        ("::", "::", 8765),
        ("", "127.0.0.1", 8765),
    ],
)
def test_a_host_a_port_or_both(text: str, host: str, port: int) -> None:
    assert Address.of(text) == Address(host, port)


@pytest.mark.parametrize(
    "text",
    [
        *("99999", "65535", "0", ":0", ":65535", "lab:99999", "lab:x", "lab:²"),
        *("[::1", "[lab]:9000", "[::1]9000", "::1::2", "http://lab:9000"),
    ],
)
def test_what_is_neither_is_refused(text: str) -> None:
    with pytest.raises(argparse.ArgumentTypeError, match=r"expected HOST, PORT or HOST:PORT .*got"):
        Address.of(text)


def test_an_ipv6_host_has_brackets_in_urls() -> None:
    assert str(Address("::1", 9000)) == "[::1]:9000"
    assert str(Address()) == "127.0.0.1:8765"


def test_an_address_of_another_machine_is_found_before_anything_is_written(
    tmp_path, capsys
) -> None:
    for host in ("192.0.2.7", "no-such-host.invalid", "a" * 70):
        out = tmp_path / "run"
        assert main(["--live", f"{host}:9000", "--out", str(out)]) == 2
        error = capsys.readouterr().err
        assert error.startswith("error: --live: expected an address of this machine with two free")
        assert f"got {host}:9000: " in error
        assert not out.exists()


@pytest.mark.parametrize("offset", [0, 1])
def test_a_port_in_use_is_found_before_the_start(offset: int) -> None:
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        with pytest.raises(InputError, match=rf"got 127\.0\.0\.1:{port}: .*in use"):
            Address("127.0.0.1", port - offset).check()


def test_the_server_listens_on_ipv6() -> None:
    _skip_without_ipv6()
    server = ViewServer("::1", 0, topics={}, pictures=(), tables={}, heard={})
    with socket.create_connection(("::1", server.port)):
        server.close()


def test_a_client_that_says_nothing_does_not_keep_the_server() -> None:
    server = ViewServer("127.0.0.1", 0, topics={}, pictures=(), tables={}, heard={})
    place = "127.0.0.1", server.port
    with socket.create_connection(place), socket.create_connection(place) as other:
        # It is turned away, so the one before it was let in.
        other.sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert other.recv(1) == b""
        server.close()


def _skip_without_ipv6() -> None:
    try:
        socket.socket(socket.AF_INET6).bind(("::1", 0))
    except OSError:
        pytest.skip("no IPv6 here")
