"""Rates, work and flatness from hand-made samples."""

import pytest

from experiment_manager.benchmark_samples import (
    Sample,
    Tenth,
    cores_elsewhere,
    cpu_ms_per_iteration,
    first_tenth,
    flatness,
    last_tenth,
    rate_hz,
)
from lockstep.errors import InputError


def _samples(*rows: tuple[float, int, float, float]) -> list[Sample]:
    """Two processes, and as much again of other work."""
    return [
        Sample(time_s, n, {"plant": a, "coder": b}, machine_cpu_s=100.0 + 2.0 * (a + b))
        for time_s, n, a, b in rows
    ]


def test_rate_and_work_lie_between_the_first_and_the_last_sample() -> None:
    samples = _samples((10.0, 100, 1.0, 2.0), (11.0, 350, 9.0, 9.0), (14.0, 900, 5.0, 2.4))
    assert rate_hz(samples) == pytest.approx(200.0)
    work_ms = cpu_ms_per_iteration(samples)
    assert work_ms == pytest.approx({"plant": 5.0, "coder": 0.5})


def test_what_others_keep_busy_is_what_is_not_ours() -> None:
    assert cores_elsewhere(_samples((0.0, 0, 1.0, 1.0), (4.0, 9, 2.0, 3.0))) == pytest.approx(0.75)


def test_the_tenths_of_an_even_run_are_alike() -> None:
    samples = _samples(*((float(i), 1000 + 50 * i, 0.1 * i, 0.2 * i) for i in range(21)))
    for tenth in (first_tenth(samples, 1000), last_tenth(samples, 1000)):
        assert (tenth.duration_s, tenth.cpu_s) == pytest.approx((2.0, 0.6))


def test_the_tenths_are_interpolated_and_at_the_ends() -> None:
    # 100 iterations; the tenths are the first 10 and the last 10 of them.
    samples = _samples(
        (0.0, 0, 0.0, 0.0),
        (2.0, 20, 1.0, 1.0),
        (5.0, 90, 4.0, 4.0),
        (7.0, 100, 5.0, 6.0),
    )
    first, last = first_tenth(samples, 100), last_tenth(samples, 100)
    assert (first.duration_s, first.cpu_s) == pytest.approx((1.0, 1.0))
    assert (last.duration_s, last.cpu_s) == pytest.approx((2.0, 3.0))


def test_a_machine_that_gets_slower_evenly_leaves_a_flat_run_flat() -> None:
    # Each later tenth takes a second longer: two runs and the beginning of a third.
    firsts, lasts = (
        [Tenth(s, 4.0) for s in (10.0, 12.0, 14.0)],
        [Tenth(11.0, 4.0), Tenth(13.0, 4.0)],
    )
    rates, work = flatness(firsts, lasts)
    assert rates == work == pytest.approx([1.0, 1.0])


def test_a_run_that_ends_at_half_the_rate_with_three_times_the_work() -> None:
    rates, work = flatness([Tenth(1.0, 1.0), Tenth(3.0, 5.0)], [Tenth(4.0, 9.0)])
    assert rates == pytest.approx([0.5])
    assert work == pytest.approx([1.0 / 3.0])


def test_flatness_needs_a_run_after_the_last() -> None:
    with pytest.raises(InputError, match="expected a first tenth more than last ones, got 1"):
        flatness([Tenth(1.0, 1.0)], [Tenth(1.0, 1.0)])


@pytest.mark.parametrize(
    "rows", [[], [(0.0, 5, 0.0, 0.0)], [(0.0, 5, 0.0, 0.0), (9.0, 5, 1.0, 1.0)]]
)
def test_a_graph_that_does_not_go_on_has_no_rate(
    rows: list[tuple[float, int, float, float]],
) -> None:
    with pytest.raises(InputError, match="expected samples of a graph that goes on"):
        rate_hz(_samples(*rows))
