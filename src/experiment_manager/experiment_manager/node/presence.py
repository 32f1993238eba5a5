"""Who is in the graph: whether each topic has its publisher, and no second one."""

from rclpy.node import Node

from experiment_manager.run.episode_record import SMALL_TOPICS

# What rclpy calls the node of a publisher that is known a moment before its node's name.
UNKNOWN_NODE = "_NODE_NAME_UNKNOWN_"
# Topics that another node than the experiment manager has to read.
_READ_BY_OTHERS = ("left/image_raw", "features")


class Presence:
    """Counts the publishers and subscribers of the graph's topics."""

    def __init__(self, node: Node) -> None:
        """node: through whose eyes the graph is seen."""
        self._node = node

    def unmatched_topics(self) -> list[str]:
        """Return the topics that lack a publisher, or a reader besides the experiment manager."""
        return self.absent_topics() + [t for t in _READ_BY_OTHERS if not self._is_read(t)]

    def _is_read(self, topic: str) -> bool:
        return bool(self._node.count_publishers(topic) and self._node.count_subscribers(topic))

    def absent_topics(self) -> list[str]:
        """Return the topics without a publisher."""
        return [topic for topic in SMALL_TOPICS if not self._node.count_publishers(topic)]

    def doubled_topics(self) -> list[str]:
        """Return the topics with more than one publisher."""
        return [topic for topic in SMALL_TOPICS if self._node.count_publishers(topic) > 1]
