"""Who is in the graph: whether each topic has its publisher, and no second one."""

from collections.abc import Sequence

from rclpy.node import Node

# What rclpy calls the node of a publisher that is known a moment before its node's name.
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
# Topics that another node than the experiment manager has to read.
_READ_BY_OTHERS = ("left/image_raw", "features")


class Presence:
    """Counts the publishers and subscribers of the graph's topics."""

    def __init__(self, node: Node, topics: Sequence[str]) -> None:
        """node: through whose eyes the graph is seen; topics: of which each has a publisher."""
        self._node, self._topics = node, topics

    def unmatched_topics(self) -> list[str]:
        """Return the topics that lack a publisher, or a reader besides the experiment manager."""
        return self.absent_topics() + [t for t in _READ_BY_OTHERS if not self._is_read(t)]

    def _is_read(self, topic: str) -> bool:
        return bool(self._node.count_publishers(topic) and self._node.count_subscribers(topic))

    def absent_topics(self) -> list[str]:
        """Return the topics without a publisher."""
        return [topic for topic in self._topics if not self._node.count_publishers(topic)]

    def doubled_topics(self) -> list[str]:
        """Return the topics with more than one publisher."""
        return [topic for topic in self._topics if self._node.count_publishers(topic) > 1]
