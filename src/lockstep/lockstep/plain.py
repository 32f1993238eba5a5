"""The switch between plain rclpy and what is faster than it."""

import os

VARIABLE = "ABV_PLAIN_ROS"


def is_plain() -> bool:
    """Whether the environment asks for plain rclpy: messages, bits and bags are the same."""
    return bool(os.environ.get(VARIABLE))
