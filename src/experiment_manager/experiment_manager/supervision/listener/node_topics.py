"""Prints who publishes topics in the domain of ROS_DOMAIN_ID, as JSON: {topic: [names]}."""

import json
import sys
import time
from collections.abc import Sequence

import rclpy
from rclpy.node import Node

from experiment_manager.node.presence import UNKNOWN_NODE
from lockstep.machine.own_process import die_with

_LOOK_PERIOD_S = 0.1


def main(parent: int, listen_s: float, topics: Sequence[str]) -> None:
    """Look until somebody is found whose name is known, for listen_s at most.

    parent: the process id of who asks, with whom this process dies.
    """
    die_with(parent)
    rclpy.init(args=[])
    node = Node("supervisor", start_parameter_services=False)
    end_s = time.monotonic() + listen_s
    found: dict[str, list[str]] = {}
    while (not found or any(UNKNOWN_NODE in names for names in found.values())) and (
        time.monotonic() < end_s
    ):
        time.sleep(_LOOK_PERIOD_S)
        infos = {topic: node.get_publishers_info_by_topic(topic) for topic in topics}
        found = {
            topic: [publisher.node_name for publisher in publishers]
            for topic, publishers in infos.items()
            if publishers
        }
    node.destroy_node()
    rclpy.try_shutdown()
    print(json.dumps(found))


if __name__ == "__main__":
    main(int(sys.argv[1]), float(sys.argv[2]), sys.argv[3:])
