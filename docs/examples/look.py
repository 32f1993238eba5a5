"""Makes eyes with saccades look at one place after the other: a gaze target every second.

usage: ROS_DOMAIN_ID=N .venv/bin/python docs/examples/look.py [SIDEWAYS_DEG UP_DEG ...]
"""

import sys
from itertools import cycle

import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState

PLACES_DEG = [float(word) for word in sys.argv[1:]] or [5.0, 0.0, 0.0, 5.0, -5.0, 0.0, 0.0, -5.0]


def main() -> None:
    """Publish targets until interrupted."""
    rclpy.init()
    node = Node("look")
    targets = node.create_publisher(JointState, "gaze_target", 1)
    places = cycle(zip(PLACES_DEG[::2], PLACES_DEG[1::2], strict=True))
    names = ["target_sideways_deg", "target_up_deg"]
    node.create_timer(
        1.0, lambda: targets.publish(JointState(name=names, position=list(next(places))))
    )
    rclpy.spin(node)


if __name__ == "__main__":
    main()
