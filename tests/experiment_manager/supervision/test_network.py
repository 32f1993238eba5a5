"""Nodes that began while the network was away."""

import errno

import psutil
import pytest

from experiment_manager.supervision.network import Network, addresses
from tests.refusing import refusing

LOOP, BOTH = frozenset({"127.0.0.1"}), frozenset({"127.0.0.1", "10.0.0.1"})


@pytest.mark.parametrize(
    ("first", "looks", "is_back"),
    [  # at each look: the addresses, whether all nodes began, whether those elsewhere were met
        (LOOP, [(LOOP, True, False)], False),
        (LOOP, [(BOTH, True, False)], True),  # without a network until others are met
        (LOOP, [(BOTH, True, True)], False),  # a new address once all have met
        (BOTH, [(BOTH, True, True), (LOOP, True, True), (BOTH, True, True)], False),  # waited out
        (BOTH, [(LOOP, False, False), (LOOP, True, False)], False),
        (BOTH, [(LOOP, False, False), (BOTH, True, False)], True),  # a cut while nodes began
        (BOTH, [(LOOP, False, True), (BOTH, True, True)], True),  # though others had been met
    ],
)
def test_the_network_is_back_for_nodes_that_began_without_it(first, looks, is_back) -> None:
    network = Network(first)
    found = [network.is_back(now, all_began=began, met=met) for now, began, met in looks]
    assert found == [False] * (len(looks) - 1) + [is_back]


def test_this_machine_has_its_loopback() -> None:
    assert "127.0.0.1" in addresses()


@pytest.mark.parametrize("number", [errno.EPERM, errno.EAFNOSUPPORT])
def test_without_netlink_there_is_none(monkeypatch, number: int) -> None:
    monkeypatch.setattr(psutil, "net_if_addrs", refusing(number))
    assert addresses() == frozenset()


def test_without_proc_every_interface_counts(monkeypatch) -> None:
    monkeypatch.setattr(psutil, "net_if_stats", refusing(errno.ENOENT))
    assert "127.0.0.1" in addresses()
