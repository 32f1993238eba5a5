import numpy as np

from active_binocular_vision.baselines.read_out import ridge


def test_ridge_by_hand():
    # Entries of mean 0 and SD 1; w = sum x e / (sum x^2 + penalty sum i) = 2 / (2 + 1 * 2).
    found = ridge(np.array([[-1.0], [1.0]]), np.array([-1.0, 1.0]), np.ones(2), 1.0)
    np.testing.assert_allclose(found.weights, [0.5])
    assert found(np.array([3.0])) == 1.5


def test_important_places_draw_mean_scale_and_slope():
    # Importance 3 and 1: mean -1/2 and 0, SD sqrt(3)/2; without penalty both places are met.
    entries, errors, importance = np.array([[-1.0], [1.0]]), np.array([-1.0, 3.0]), [3.0, 1.0]
    found = ridge(entries, errors, np.array(importance), 0.0)
    np.testing.assert_allclose([found.mean[0], found.offset], [-0.5, 0.0])
    np.testing.assert_allclose(found.scale, [np.sqrt(0.75)])
    np.testing.assert_allclose(found(entries), errors)


def test_a_linear_error_is_found_and_an_entry_that_stays_is_ignored():
    draw = np.random.default_rng(1)
    entries = draw.normal(size=(200, 4)) * [1.0, 10.0, 0.1, 0.0] + [0.0, 5.0, 1.0, 7.0]
    errors = entries[:, 0] - 0.3 * entries[:, 1] + 20.0 * entries[:, 2]
    found = ridge(entries, errors, draw.uniform(0.1, 1.0, 200), 1e-9)
    np.testing.assert_allclose(found(entries), errors, atol=1e-5)
    np.testing.assert_allclose(found.weights[3], 0.0, atol=1e-12)
