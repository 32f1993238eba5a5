"""Stamps: the number of an observation times the nominal control period, in whole nanoseconds.

Every message about an observation carries its stamp, and lies in the bag at that time.
"""

from builtin_interfaces.msg import Time

from lockstep.errors import InputError

NS_PER_S = 1_000_000_000
# The last that a ROS time, with its 32-bit seconds, can carry.
MAX_STAMP_NS = (1 << 31) * NS_PER_S - 1


def period_ns(control_period_s: float) -> int:
    """Return the control period in whole nanoseconds."""
    return round(control_period_s * NS_PER_S)


def check_stamp(observation: int, control_period_ns: int) -> None:
    """Raise InputError where the stamp of an observation's number is later than ROS has."""
    stamp_ns = observation * control_period_ns
    if stamp_ns > MAX_STAMP_NS:
        raise InputError(f"expected stamps below 2^31 s, got one of {stamp_ns / NS_PER_S:g} s")


def to_time(stamp_ns: int) -> Time:
    """Return the ROS time of a stamp; stamp_ns in [0, MAX_STAMP_NS]."""
    return Time(sec=stamp_ns // NS_PER_S, nanosec=stamp_ns % NS_PER_S)


def checked_stamp(sec: int, nanosec: int) -> int:
    """Return the stamp of seconds and nanoseconds that came from elsewhere, in nanoseconds.

    Raises InputError for a time that no stamp can have.
    """
    if sec < 0 or nanosec >= NS_PER_S:
        raise InputError(f"stamp: expected sec >= 0 and nanosec < 10^9, got {sec} s, {nanosec} ns")
    return sec * NS_PER_S + nanosec
