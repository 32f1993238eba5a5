"""Rates, work and flatness from hand-made samples."""

import pytest

from lockstep.errors import InputError
from tests.benchmark.samples import Sample, cores_elsewhere, cpu_ms_per_iteration, flatness, rate_hz


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


def test_an_even_run_is_flat() -> None:
    samples = _samples(*((float(i), 1000 + 50 * i, 0.1 * i, 0.2 * i) for i in range(21)))
    assert flatness(samples) == pytest.approx((1.0, 1.0))


def test_a_run_that_ends_at_half_the_rate_with_three_times_the_work() -> None:
    # 100 iterations; the tenths are the first 10 and the last 10 of them.
    samples = _samples(
        (0.0, 0, 0.0, 0.0), (1.0, 10, 0.5, 0.5), (5.0, 90, 4.0, 4.0), (7.0, 100, 5.0, 6.0)
    )
    assert flatness(samples) == pytest.approx((0.5, 1.0 / 3.0))


@pytest.mark.parametrize(
    "rows", [[], [(0.0, 5, 0.0, 0.0)], [(0.0, 5, 0.0, 0.0), (9.0, 5, 1.0, 1.0)]]
)
def test_a_graph_that_does_not_go_on_has_no_rate(rows) -> None:
    with pytest.raises(InputError, match="expected samples of a graph that goes on"):
        rate_hz(_samples(*rows))
