"""Quality of service of every topic of the graph."""

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

# Reliable DDS drops what a slow reader's queue cannot hold. A test episode sends 21 messages per
# topic and repeats one each second while it waits; the next episode comes only when all are read.
QUEUE_DEPTH = 64

LOCKSTEP_QOS = QoSProfile(
    history=HistoryPolicy.KEEP_LAST,
    depth=QUEUE_DEPTH,
    reliability=ReliabilityPolicy.RELIABLE,
    durability=DurabilityPolicy.VOLATILE,
)
