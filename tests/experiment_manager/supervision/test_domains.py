"""A domain of one's own: free, and locked while used."""

import errno
import socket
import tempfile
from typing import Any

import pytest

from experiment_manager.supervision import domains
from experiment_manager.supervision.domains import NODE_SCRIPTS_DOMAIN, own_domain
from lockstep import InputError
from tests.refusing import refusing


def test_everybodys_domains_are_never_taken() -> None:
    with own_domain() as domain:
        assert 1 <= domain <= 101
        assert domain != NODE_SCRIPTS_DOMAIN


def test_two_at_once_differ() -> None:
    with own_domain() as first, own_domain() as second:
        assert first != second


def test_a_domain_may_be_taken_again_once_left() -> None:
    # One of the last, since the first ones are what tests beside this one take.
    with own_domain(frozenset(range(1, 91))) as domain:
        pass
    others = frozenset(range(1, 102)) - {domain}
    for _ in range(2):
        with own_domain(others) as again:
            assert again == domain


@pytest.mark.parametrize("participant", [0, 31])
def test_a_domain_with_somebody_in_it_is_not_taken(participant: int) -> None:
    with own_domain() as domain:
        pass
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as somebody:
        # RTPS: participant p of a domain listens for unicast discovery on 7400 + 250 d + 10 + 2 p.
        somebody.bind(("", 7400 + 250 * domain + 10 + 2 * participant))
        with own_domain() as other:
            assert other != domain


def test_none_free() -> None:
    with (
        pytest.raises(InputError, match="expected a free ROS domain between 1 and 101"),
        own_domain(frozenset(range(1, 102))),
    ):
        pass


def test_a_domain_needs_no_file(monkeypatch) -> None:
    monkeypatch.setattr(tempfile, "tempdir", "/nowhere")
    with own_domain() as first, own_domain() as second:
        assert first != second


@pytest.mark.parametrize("call", ["__init__", "bind"])
def test_without_abstract_names_the_ports_decide(monkeypatch, call: str) -> None:
    class Sandboxed(socket.socket):
        def __init__(self, family: int, kind: int) -> None:
            if (family, call) == (socket.AF_UNIX, "__init__"):
                refusing(errno.EAFNOSUPPORT)()
            super().__init__(family, kind)

        def bind(self, address: Any) -> None:
            if self.family == socket.AF_UNIX:
                refusing(errno.EACCES)()
            super().bind(address)

    monkeypatch.setattr(domains.socket, "socket", Sandboxed)
    with own_domain() as domain:
        assert domain >= 1
