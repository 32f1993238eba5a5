"""Stamps: whole nanoseconds, there and back, and what no stamp can be."""

import pytest
from builtin_interfaces.msg import Time

from lockstep import InputError
from lockstep.wire.stamps import MAX_STAMP_NS, checked_stamp, period_ns, to_time


@pytest.mark.parametrize(
    ("period_s", "expected_ns"), [(0.1, 100_000_000), (0.01, 10_000_000), (1 / 3, 333_333_333)]
)
def test_period_is_rounded_to_whole_nanoseconds(period_s: float, expected_ns: int) -> None:
    assert period_ns(period_s) == expected_ns


@pytest.mark.parametrize("stamp_ns", [0, 1, 999_999_999, 1_000_000_000, MAX_STAMP_NS])
def test_there_and_back(stamp_ns: int) -> None:
    time = to_time(stamp_ns)
    assert checked_stamp(time.sec, time.nanosec) == stamp_ns


@pytest.mark.parametrize(
    "time", [Time(sec=-1), Time(sec=-1, nanosec=999_999_999), Time(nanosec=1_000_000_000)]
)
def test_what_is_no_stamp_is_refused(time: Time) -> None:
    with pytest.raises(InputError, match="stamp: expected sec >= 0 and nanosec < 10"):
        checked_stamp(time.sec, time.nanosec)
