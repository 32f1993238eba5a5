"""The supervisor's own node in a ROS domain, and others' graphs that it finds there."""

import os
import time
from collections.abc import Collection, Sequence
from contextlib import closing, nullcontext

from rclpy.context import Context
from rclpy.executors import SingleThreadedExecutor
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from experiment_manager.node.presence import UNKNOWN_NODE
from experiment_manager.supervision.domains import is_silent, own_domain
from lockstep import InputError
from lockstep.machine.domain import enter_environment
from lockstep.machine.environment import is_usual, reaches_other_machines
from lockstep.node.process import with_log_files_where_asked
from lockstep.wire.topics import CODER_VECTORS, LEARNER_VECTORS, PLANT_VECTORS

PUBLISHES = {
    "eye_plant": PLANT_VECTORS,
    "sparse_coder": CODER_VECTORS,
    "vergence_rl": LEARNER_VECTORS,
}
# Longer than Fast DDS' period of announcements, 3 s.
_LISTEN_S = 5.0
_LOOK_PERIOD_S = 0.1
# Twice the longest that it took at a load of 17 on two cores, and twice again.
_MEET_S = 15.0
_VARIABLES = ("ROS_", "RMW_", "FASTRTPS_", "FASTDDS_")


class Observer:
    """A node in a domain that answers nobody; it stays until it is closed."""

    def __init__(self, domain: int) -> None:
        """Enter the domain."""
        self._context = Context()
        self._context.init(args=with_log_files_where_asked([]), domain_id=domain)
        self.node = Node(
            "supervisor", context=self._context, enable_rosout=False, start_parameter_services=False
        )
        self.executor = SingleThreadedExecutor(context=self._context)
        self.executor.add_node(self.node)

    def close(self) -> None:
        """Leave the domain."""
        self.executor.shutdown()
        self.node.destroy_node()
        self._context.try_shutdown()


def check_ros(domain: int | None, expected: Collection[str] = ()) -> None:
    """Enter the environment of nodes; raise InputError where the nodes of a run could not meet.

    domain: in which others expect them, None for any; expected: as `refuse_neighbours` has it.
    """
    enter_environment()
    if domain is not None:
        refuse_neighbours(domain, expected)
    if not expected and not is_usual():
        with own_domain() if domain is None else nullcontext(domain) as where:
            _refuse_strangers(where)


def _refuse_strangers(domain: int) -> None:
    """Raise InputError unless two nodes can be made in the domain and find each other."""
    why = "they do not find each other"
    try:
        with closing(Observer(domain)) as one, closing(Observer(domain)) as other:
            end_s = time.monotonic() + _MEET_S
            while time.monotonic() < end_s:
                if all(len(each.node.get_node_names()) > 1 for each in (one, other)):
                    return
                time.sleep(_LOOK_PERIOD_S)
    except rclpy_implementation.RCLError as error:
        why = " ".join(str(error).split())
    given = (f"{n}={v}" for n, v in sorted(os.environ.items()) if n.startswith(_VARIABLES))
    raise InputError(f"expected two nodes to meet here, but {why}, with {', '.join(given)}")


def refuse_neighbours(domain: int, expected: Collection[str] = ()) -> None:
    """Raise InputError when somebody in the domain publishes our topics.

    expected: nodes that may be there already. Pure listeners are allowed. Takes a few
    seconds, unless nobody else can be in the domain.
    """
    if is_silent(domain) and not reaches_other_machines(os.environ):
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
    """Return the names of the nodes that publish each topic, as soon as all that are found are."""
    observer = Observer(domain)
    end_s = time.monotonic() + _LISTEN_S
    found: dict[str, list[str]] = {}
    try:
        while (not found or any(UNKNOWN_NODE in names for names in found.values())) and (
            time.monotonic() < end_s
        ):
            time.sleep(_LOOK_PERIOD_S)
            infos = {topic: observer.node.get_publishers_info_by_topic(topic) for topic in topics}
            found = {
                topic: [publisher.node_name for publisher in publishers]
                for topic, publishers in infos.items()
                if publishers
            }
    finally:
        observer.close()
    return found
