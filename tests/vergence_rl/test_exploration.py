import math

import pytest

from vergence_rl.exploration import exploration_sd, step_scale


@pytest.mark.parametrize(
    ("wide", "done", "sd"),
    [(0.0, 0.0, 0.03), (0.0, 0.5, 0.003), (0.0, 1.0, 0.0003), (0.4, 0.4, 0.03), (0.4, 0.7, 0.003)],
)
def test_the_noise_narrows_exponentially(wide: float, done: float, sd: float) -> None:
    assert exploration_sd(0.03, wide, 0.01, done) == pytest.approx(sd)


def test_the_papers_noise_stays_as_it_is() -> None:
    assert [exploration_sd(0.003, 0.0, 1.0, done) for done in (0.0, 0.3, 1.0)] == 3 * [0.003]


@pytest.mark.parametrize(
    ("times_the_papers", "exponent", "scale"),
    [(1.0, 0.7, 1.0), (5.0, 0.0, 1.0), (4.0, 1.0, 0.25), (0.25, 0.5, 2.0), (0.0, 1.0, 1.0)],
)
def test_a_step_is_longer_the_narrower_the_noise(
    times_the_papers: float, exponent: float, scale: float
) -> None:
    assert step_scale(times_the_papers * math.sqrt(1e-5), exponent) == pytest.approx(scale)
