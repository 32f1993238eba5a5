"""Stamps of messages that rclpy has read."""

from builtin_interfaces.msg import Time

from lockstep.wire.stamps import NS_PER_S


def to_ns(time: Time) -> int:
    """Return the stamp of a ROS time in nanoseconds."""
    return int(time.sec) * NS_PER_S + int(time.nanosec)
