import numpy as np
import pytest

from active_binocular_vision.learners.gabor import fit_gabors
from lockstep import InputError
from tests.active_binocular_vision.learners.gabor_patch import gabor_patch


def random_parameters(n):
    draw = np.random.default_rng(1)
    return [
        {
            "wave_angle_deg": draw.uniform(-90.0, 90.0),
            "wavelength_px": draw.uniform(3.0, 7.0),
            "x_px": draw.uniform(-1.5, 1.5),
            "y_px": draw.uniform(-1.5, 1.5),
            "width_px": draw.uniform(1.5, 2.2),
            "length_px": draw.uniform(1.5, 3.0),
            "phase_rad": draw.uniform(-3.0, 3.0),
        }
        for _ in range(n)
    ]


def angle_between(first, second, period):
    return abs((first - second + period / 2.0) % period - period / 2.0)


def test_known_gabor_functions_are_found_again():
    wanted = random_parameters(40)
    found = fit_gabors(np.stack([gabor_patch(**p) for p in wanted])[:, None])
    assert found.residual.max() < 1e-6
    assert found.is_good.all()
    for i, parameters in enumerate(wanted):
        angle = parameters["wave_angle_deg"]
        assert angle_between(found.wave_angle_deg[i], angle, 180.0) < 0.5
        assert angle_between(found.orientation_deg[i], angle + 90.0, 180.0) < 0.5
        assert found.wavelength_px[i] == pytest.approx(parameters["wavelength_px"], rel=0.02)


def test_a_fit_is_no_worse_than_that_of_an_independent_solver():
    from scipy.optimize import least_squares

    random = np.random.default_rng(2)
    targets = np.stack([gabor_patch(**p) for p in random_parameters(5)])
    targets += 0.1 * random.standard_normal(targets.shape)
    targets /= np.linalg.norm(targets, axis=1, keepdims=True)
    found = fit_gabors(targets[:, None])
    names = ("wave_angle_deg", "wavelength_px", "x_px", "y_px", "width_px", "length_px")
    lowest, highest = [-400, 2, -4, -4, 0.5, 0.5, -10, -10], [400, 16, 4, 4, 8, 8, 10, 10]
    for i, target in enumerate(targets):

        def residuals(p, target=target):
            return p[7] * gabor_patch(**dict(zip(names, p, strict=False)), phase_rad=p[6]) - target

        best = min(
            least_squares(
                residuals,
                [random.uniform(-90, 90), *random.uniform(2.5, 8, 1), 0, 0, 2, 2, 0, 0.5],
                bounds=(lowest, highest),
            ).cost
            for _ in range(12)
        )
        assert found.residual[i] <= 2.0 * best + 1e-6


def test_amplitude_and_phase_are_each_eyes_own():
    both = np.stack([0.5 * gabor_patch(phase_rad=0.2), 0.1 * gabor_patch(phase_rad=1.3)])
    found = fit_gabors(both[None])
    assert found.residual[0] < 1e-6
    assert found.patches[0] == pytest.approx(both, abs=1e-3)
    difference = found.phase_rad[0, 1] - found.phase_rad[0, 0]
    assert angle_between(difference, 1.1, 2 * np.pi) < 0.01


@pytest.mark.parametrize(
    "other_eye", [gabor_patch(wave_angle_deg=-70.0), np.random.default_rng(0).standard_normal(64)]
)
def test_eyes_that_see_different_things_share_no_gabor_function(other_eye):
    halves = np.stack([gabor_patch(), other_eye])
    halves /= np.linalg.norm(halves, axis=1, keepdims=True)
    assert not fit_gabors(halves[None]).is_good[0]
    assert fit_gabors(halves[:1, None]).is_good[0]


def test_nothing_is_fitted_to_an_empty_patch():
    assert fit_gabors(np.zeros((1, 2, 64))).residual == pytest.approx([1.0])


def test_the_scale_of_a_patch_does_not_matter():
    noisy = gabor_patch() + 0.2 * np.random.default_rng(3).standard_normal(64)
    small, large = (fit_gabors(factor * noisy[None, None]) for factor in (1e-3, 1e3))
    assert small.residual == pytest.approx(large.residual, rel=1e-6)


def test_another_shape_is_refused():
    with pytest.raises(InputError, match=r"expected patches \(n, n_eyes, 64\)"):
        fit_gabors(np.zeros((4, 128)))
