import numpy as np
import pytest

from active_binocular_vision.examinations.code.tuning import scale_row
from active_binocular_vision.learners.basis_functions import left_share, tuning
from tests.active_binocular_vision.learners.gabor_patch import atom, gabor_patch, shifted_wave


@pytest.mark.parametrize("wave_angle_deg", [0.0, 30.0, -50.0])
@pytest.mark.parametrize("shift_px", [-2.0, -0.5, 0.0, 1.5])
def test_the_preferred_disparity_is_the_shift_of_the_left_pattern(shift_px, wave_angle_deg):
    found = tuning(shifted_wave(shift_px, wave_angle_deg)[None], px_per_pixel=4.0)
    assert found.disparity_px[0] == pytest.approx(4.0 * shift_px, abs=0.1)


def test_disparities_are_told_as_angles():
    atoms = shifted_wave(1.0, 0.0)[None]
    kept = scale_row("fine", tuning(atoms, px_per_pixel=1.0), atoms, 0.2226)
    assert kept.preferred_disparities_deg[0] == pytest.approx(0.2226, abs=0.003)


def test_horizontal_stripes_and_monocular_atoms_tell_no_disparity():
    atoms = np.stack([shifted_wave(0.0, 88.0), atom(gabor_patch(), 0.02 * gabor_patch())])
    found = tuning(atoms, px_per_pixel=1.0)
    assert found.is_common_gabor.all()
    assert np.isnan(found.disparity_px).all()


def test_a_shift_beyond_half_a_patch_is_no_preferred_disparity():
    atoms = np.stack([shifted_wave(shift_px, 0.0, wavelength_px=14.0) for shift_px in (3.5, 5.0)])
    found = tuning(atoms, px_per_pixel=1.0)
    assert found.is_common_gabor.all()
    assert found.disparity_px[0] == pytest.approx(3.5, abs=0.1)
    assert np.isnan(found.disparity_px[1])


def test_orientations_are_counted_around_horizontal_first():
    atoms = np.stack([shifted_wave(0.0, angle) for angle in (89.0, -89.0, 0.0, 2.0, 46.0)])
    # Stripes at 179, 1 (both horizontal), 90, 92 and 136 deg.
    assert tuning(atoms, 1.0).orientation_counts().tolist() == [2, 0, 0, 0, 2, 0, 1, 0]


def test_binocularity_compares_the_responses_to_the_dominant_eyes_stimulus():
    weights = np.array([0.0, 0.1, 0.5, 1.0, 2.0, 10.0, 1e6])
    atoms = np.stack([atom(gabor_patch(), weight * gabor_patch()) for weight in weights])
    found = tuning(atoms, 1.0)
    assert found.binocularity == pytest.approx((weights - 1) / (weights + 1), abs=1e-4)
    # -1, -0.82, -0.33, 0, 0.33, 0.82, 1
    assert found.binocularity_counts().tolist() == [1] * 7


def test_halves_that_want_different_stimuli_are_monocular():
    odd = np.pi / 2.0
    crossed = atom(
        1.1 * gabor_patch(phase_rad=odd), gabor_patch(wave_angle_deg=90.0, phase_rad=odd)
    )
    assert tuning(crossed[None], 1.0).binocularity[0] < -0.85


def test_an_atom_is_as_gabor_as_the_half_of_its_dominant_eye():
    noise = np.random.default_rng(0).standard_normal(64)
    noise /= np.linalg.norm(noise)
    good = gabor_patch() / np.linalg.norm(gabor_patch())
    atoms = np.stack([atom(good, 0.7 * noise), atom(0.7 * noise, good), atom(0.3 * good, noise)])
    found = tuning(atoms, 1.0)
    assert found.is_gabor.tolist() == [True, True, False]
    assert found.is_common_gabor.tolist() == [False, False, False]
    kept = scale_row("fine", found, atoms, 0.2226)
    assert kept.gabor_share == pytest.approx(2 / 3)
    assert kept.common_gabor_share == 0.0
    # What is no Gabor function is in no histogram.
    assert found.orientation_counts().sum() == found.binocularity_counts().sum() == 2


def test_the_residual_of_a_half_is_a_share_of_the_whole_atom():
    noise = np.random.default_rng(0).standard_normal(64)
    noise *= 0.5 * np.linalg.norm(gabor_patch()) / np.linalg.norm(noise)
    alone, beside = (
        tuning(atom(gabor_patch() + noise, w * gabor_patch())[None], 1.0) for w in (0.0, 0.8)
    )
    energy = ((gabor_patch() + noise) ** 2).sum()
    whole = energy + (0.8**2) * (gabor_patch() ** 2).sum()
    assert beside.residual[0] == pytest.approx(alone.residual[0] * energy / whole)


def test_the_share_of_an_eye_weighs_atoms_by_their_part_in_the_code():
    only_left, only_right = (
        atom(gabor_patch(), 0 * gabor_patch()),
        atom(0 * gabor_patch(), gabor_patch()),
    )
    balanced = atom(gabor_patch(), gabor_patch())
    atoms = np.stack([only_left, only_right, balanced])
    assert left_share(np.array([3.0, 1.0, 0.0]), atoms) == pytest.approx(0.75)
    assert left_share(np.array([0.0, 0.0, 5.0]), atoms) == pytest.approx(0.5)
    assert left_share(np.array([1.0, 0.0, 1.0]), atoms) == pytest.approx(0.75)
    assert np.isnan(left_share(np.zeros(3), atoms))


def test_both_scales_have_one_share():
    atoms = np.stack(
        [[atom(gabor_patch(), 0 * gabor_patch())], [atom(0 * gabor_patch(), gabor_patch())]]
    )
    assert left_share(np.array([[3.0], [1.0]]), atoms) == pytest.approx(0.75)
