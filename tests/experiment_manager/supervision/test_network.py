"""Nodes that began while the network was away."""

from experiment_manager.supervision.network import Network, addresses

LOOP, BOTH = frozenset({"127.0.0.1"}), frozenset({"127.0.0.1", "10.0.0.1"})


def test_without_a_network_until_others_are_met() -> None:
    network = Network(LOOP)
    assert not network.is_back(LOOP, all_began=True, met=False)
    assert network.is_back(BOTH, all_began=True, met=False)


def test_a_new_address_once_all_have_met() -> None:
    assert not Network(LOOP).is_back(BOTH, all_began=True, met=True)


def test_a_cut_after_all_began_is_waited_out() -> None:
    network = Network(BOTH)
    for now in (BOTH, LOOP, BOTH):
        assert not network.is_back(now, all_began=True, met=True)


def test_a_cut_while_nodes_began() -> None:
    network = Network(BOTH)
    assert not network.is_back(LOOP, all_began=False, met=False)
    assert not network.is_back(LOOP, all_began=True, met=False)
    assert network.is_back(BOTH, all_began=True, met=False)


def test_a_cut_while_nodes_began_though_others_had_been_met() -> None:
    network = Network(BOTH)
    assert not network.is_back(LOOP, all_began=False, met=True)
    assert network.is_back(BOTH, all_began=True, met=True)


def test_this_machine_has_its_loopback() -> None:
    assert "127.0.0.1" in addresses()
