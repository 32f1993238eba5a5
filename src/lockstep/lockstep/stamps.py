"""Stamps: the number of an observation times the nominal control period, in whole nanoseconds."""

from builtin_interfaces.msg import Time

_NS_PER_S = 1_000_000_000


def period_ns(control_period_s: float) -> int:
    """Return the control period in whole nanoseconds."""
    return round(control_period_s * _NS_PER_S)


def to_time(stamp_ns: int) -> Time:
    """Return the ROS time of a stamp; stamp_ns in [0, 2^31 s)."""
    return Time(sec=stamp_ns // _NS_PER_S, nanosec=stamp_ns % _NS_PER_S)


def to_ns(time: Time) -> int:
    """Return the stamp of a ROS time in nanoseconds."""
    return int(time.sec) * _NS_PER_S + int(time.nanosec)
