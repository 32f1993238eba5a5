"""Who is in the graph: whether each topic has its publisher, and no second one."""

import time
from collections.abc import Sequence

from rclpy.node import Node

# What rclpy calls the node of a publisher that is known a moment before its node's name.
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
# Topics that another node than the experiment manager has to read.
_READ_BY_OTHERS = ("left/image_raw", "features")
# Fast DDS goes on to count a process that was killed for 20 s, its lease; some more to notice.
LEASE_S = 25.0


class Presence:
    """Counts the publishers and subscribers of the graph's topics."""

    def __init__(self, node: Node, topics: Sequence[str]) -> None:
        """node: through whose eyes the graph is seen; topics: of which each has a publisher."""
        self._node, self._topics = node, topics
        # By topic and number of publishers, since when there have been so many.
        self._doubled_since_s: dict[tuple[str, int], float] = {}

    def unmatched_topics(self) -> list[str]:
        """Return the topics that lack a publisher, or a reader besides the experiment manager."""
        return self.absent_topics() + [t for t in _READ_BY_OTHERS if not self._is_read(t)]

    def _is_read(self, topic: str) -> bool:
        return bool(self._node.count_publishers(topic) and self._node.count_subscribers(topic))

    def absent_topics(self) -> list[str]:
        """Return the topics without a publisher."""
        return [topic for topic in self._topics if not self._node.count_publishers(topic)]

    def doubled_topics(self) -> tuple[list[str], list[str]]:
        """Return the topics with two publishers for certain, and those where one may be dead.

        A node that was killed and started again is there twice until the lease of the dead one
        ends: publishers of one name are in doubt for so long.
        """
        now_s, since_s = time.monotonic(), self._doubled_since_s
        counts = [(topic, self._node.count_publishers(topic)) for topic in self._topics]
        self._doubled_since_s = {key: since_s.get(key, now_s) for key in counts if key[1] > 1}
        certain: list[str] = []
        doubtful: list[str] = []
        for (topic, _), first_s in self._doubled_since_s.items():
            may_be_dead = now_s - first_s < LEASE_S and self._is_of_one_name(topic)
            (doubtful if may_be_dead else certain).append(topic)
        return certain, doubtful

    def _is_of_one_name(self, topic: str) -> bool:
        publishers = self._node.get_publishers_info_by_topic(topic)
        names = {(publisher.node_namespace, publisher.node_name) for publisher in publishers}
        return len([name for name in names if UNKNOWN_NODE not in name[1]]) < 2
