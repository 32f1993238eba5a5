"""What lies beyond this process' own nodes: others' graphs in a ROS domain, and the network."""

import json
import os
import socket
import subprocess
import sys
from collections.abc import Collection, Sequence

import psutil

from experiment_manager.supervision.domains import is_silent
from experiment_manager.supervision.heartbeats import START_LIMIT_S, unfinished_text
from lockstep.errors import InputError
from lockstep.machine.unfinished_ports import remove_unfinished_ports
from lockstep.wire.topics import CODER_VECTORS, LEARNER_VECTORS, PLANT_VECTORS

PUBLISHES = {
    "eye_plant": PLANT_VECTORS,
    "sparse_coder": CODER_VECTORS,
    "vergence_rl": LEARNER_VECTORS,
}
# Longer than Fast DDS' period of announcements, 3 s.
_LISTEN_S = 5.0


def addresses() -> frozenset[str]:
    """Return the IPv4 addresses of this machine's interfaces that work now, loopback too.

    Fast DDS tells others the addresses that it finds when a node starts.
    """
    works = {name for name, state in psutil.net_if_stats().items() if state.isup}
    return frozenset(
        address.address
        for name, of_interface in psutil.net_if_addrs().items()
        for address in of_interface
        if name in works and address.family == socket.AF_INET
    )


def refuse_neighbours(domain: int, expected: Collection[str] = ()) -> None:
    """Raise InputError when somebody in the domain publishes our topics.

    expected: nodes that may be there already. Pure listeners are allowed. Takes a few
    seconds, unless nobody else can be in the domain.
    """
    if is_silent(domain) and not _reaches_other_machines():
        return
    publishers = _publishers(
        domain, [t for node, topics in PUBLISHES.items() if node not in expected for t in topics]
    )
    if publishers:
        names = sorted({name for names in publishers.values() for name in names})
        raise InputError(
            f"ROS domain {domain}: expected no other graph in it, found {', '.join(names)} "
            f"publishing {', '.join(publishers)}; choose another ROS_DOMAIN_ID, or unset it"
        )


def _publishers(domain: int, topics: Sequence[str]) -> dict[str, list[str]]:
    """Return the names of the nodes that publish each topic, by topic, as soon as there are any.

    A process looks that a limit of time, Ctrl-C and our own end can end: to make a node may hang
    for ever.
    """
    remove_unfinished_ports()
    module = "experiment_manager.supervision.listener.node_topics"
    try:
        done = subprocess.run(
            [sys.executable, "-m", module, str(os.getpid()), str(_LISTEN_S), *topics],
            env=os.environ | {"ROS_DOMAIN_ID": str(domain)},
            capture_output=True,
            text=True,
            timeout=START_LIMIT_S,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        raise InputError(
            f"ROS domain {domain}: expected a node to start within {START_LIMIT_S:g} s, it hangs"
            f"{unfinished_text()}"
        ) from error
    *_, last = ["", *(done.stderr if done.returncode else done.stdout).splitlines()]
    if done.returncode:
        raise InputError(f"ROS domain {domain}: expected a node to start in it, got {last}")
    publishers: dict[str, list[str]] = json.loads(last)
    return publishers


def _reaches_other_machines() -> bool:
    peers = os.environ.get("ROS_STATIC_PEERS", "")
    return bool(peers) or os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE") != "LOCALHOST"
