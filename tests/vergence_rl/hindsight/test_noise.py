import numpy as np
import pytest
from numpy.typing import NDArray

from vergence_rl.hindsight.noise import FirstNoise, root_of, widened


def test_noise_without_a_shape_is_known_at_once() -> None:
    noise = FirstNoise(3, 0.25, 0.0)
    assert noise.is_known
    assert noise.covariance.tolist() == (0.25 * np.eye(3)).tolist()
    assert noise.metric.tolist() == np.eye(3).tolist()


def test_noise_takes_the_shape_of_first_places() -> None:
    draw = np.random.default_rng(1)
    root = np.array([[0.03, 0.0], [0.02, 0.01]])
    places = 0.1 + draw.normal(size=(20, 2)) @ root.T
    noise = FirstNoise(2, 4e-4, 0.5)
    for place in places[:-1]:
        noise.add(place)
        assert not noise.is_known
    noise.add(places[-1])
    assert noise.is_known
    assert noise.covariance == pytest.approx(0.25 * np.cov(places.T, bias=True), rel=1e-4)
    # A change as large as the noise's SD has the length of the SD of noise without a shape.
    values, axes = np.linalg.eigh(noise.covariance)
    for value, axis in zip(values, axes.T, strict=True):
        assert np.linalg.norm(np.sqrt(value) * axis @ noise.metric) == pytest.approx(0.02)


def test_places_that_are_alike_in_a_direction_leave_a_little_noise_there() -> None:
    draw = np.random.default_rng(3)
    noise = FirstNoise(2, 1e-4, 0.3)
    for size in draw.random(20):
        noise.add(np.array([0.05, 0.1]) + 0.02 * size)  # both muscles together alone
    assert np.isfinite(noise.metric).all()
    across = np.array([1.0, -1.0]) / np.sqrt(2.0)
    assert 0.0 < across @ noise.covariance @ across < 1e-9


@pytest.mark.parametrize("covariance", [np.array([[4.0, 1.0], [1.0, 2.0]]), np.ones((2, 2))])
def test_a_root_squared_is_the_covariance(covariance: NDArray[np.float64]) -> None:
    root = root_of(covariance)
    np.testing.assert_allclose(root @ root, covariance, atol=1e-12)
    np.testing.assert_allclose(root, root.T, atol=1e-12)


def test_a_covariance_is_widened_where_it_has_less() -> None:
    axes = np.array([[0.6, -0.8], [0.8, 0.6]])
    narrow = axes @ np.diag([4.0, 0.01]) @ axes.T
    np.testing.assert_allclose(widened(narrow, np.eye(2)), axes @ np.diag([4.0, 1.0]) @ axes.T)
    # In the shape of the least one: of its SDs 1 and 3, the narrow one has twice and a third.
    got = widened(np.diag([4.0, 1.0]), np.diag([1.0, 9.0]))
    np.testing.assert_allclose(got, np.diag([4.0, 9.0]), atol=1e-12)


def test_rounding_below_zero_has_no_root() -> None:
    np.testing.assert_array_equal(root_of(np.diag([1.0, -1e-20])), np.diag([1.0, 0.0]))


def test_noise_goes_on_where_it_stopped() -> None:
    draw = np.random.default_rng(2)
    whole, first, second = (FirstNoise(2, 1e-4, 0.3) for _ in range(3))
    for i, place in enumerate(draw.random((20, 2))):
        whole.add(place)
        if i == 10:
            second.restore(first.state())
        (first if i < 10 else second).add(place)
    assert second.covariance.tolist() == whole.covariance.tolist()
    assert second.metric.tolist() == whole.metric.tolist()
