import numpy as np
import pytest

from experiment_manager.rearing.basis_functions import (
    binocularity_of,
    left_share,
    tuning,
)
from experiment_manager.rearing.gabor import gabor_patch


def half(x_px=0.0, **changed):
    return gabor_patch(
        **{
            "wave_angle_deg": 0.0,
            "wavelength_px": 6.0,
            "x_px": x_px,
            "y_px": 0.0,
            "width_px": 1.8,
            "length_px": 2.5,
            "phase_rad": 0.0,
        }
        | changed
    )


def atom(left, right):
    both = np.concatenate([left, right])
    return both / np.linalg.norm(both)


def shifted_wave(shift_px, wave_angle_deg):
    """Both eyes under one envelope, the left eye's wave moved right by shift_px."""
    along_px = shift_px * np.cos(np.radians(wave_angle_deg))
    phase_rad = -2.0 * np.pi * along_px / 6.0
    left, right = (half(wave_angle_deg=wave_angle_deg, phase_rad=p) for p in (phase_rad, 0.0))
    return atom(left, right)


@pytest.mark.parametrize("wave_angle_deg", [0.0, 30.0, -50.0])
@pytest.mark.parametrize("shift_px", [-2.0, -0.5, 0.0, 1.5])
def test_the_preferred_disparity_is_the_shift_of_the_left_pattern(shift_px, wave_angle_deg):
    found = tuning(shifted_wave(shift_px, wave_angle_deg)[None], px_per_pixel=4.0)
    assert found.disparity_px[0] == pytest.approx(4.0 * shift_px, abs=0.1)


def test_disparities_are_told_as_angles():
    found = tuning(shifted_wave(1.0, 0.0)[None], px_per_pixel=1.0)
    # One pixel at F = 257.34 px is 0.2226 deg (K17).
    assert found.disparities_deg(257.34)[0] == pytest.approx(0.2226, abs=0.003)


def test_horizontal_stripes_and_monocular_atoms_tell_no_disparity():
    atoms = np.stack([shifted_wave(0.0, 88.0), atom(half(), 0.02 * half())])
    found = tuning(atoms, px_per_pixel=1.0)
    assert found.is_gabor.all()
    assert np.isnan(found.disparity_px).all()


def test_orientations_are_counted_around_horizontal_first():
    atoms = np.stack([shifted_wave(0.0, angle) for angle in (89.0, -89.0, 0.0, 2.0, 46.0)])
    # Stripes at 179, 1 (both horizontal), 90, 92 and 136 deg.
    assert tuning(atoms, 1.0).orientation_counts().tolist() == [2, 0, 0, 0, 2, 0, 1, 0]


def test_binocularity_compares_the_norms_of_the_halves():
    left, right = np.eye(64)[0], np.eye(64)[1]
    atoms = np.stack(
        [
            np.concatenate([left, 0 * right]),
            np.concatenate([left, right]),
            np.concatenate([left, 3 * right]),
        ]
    )
    assert binocularity_of(atoms) == pytest.approx([-1.0, 0.0, 0.5])


def test_all_atoms_are_counted_in_seven_bins_of_binocularity():
    weights = [0.0, 0.1, 0.5, 1.0, 2.0, 10.0, 1e6]
    atoms = np.stack([atom(half(), weight * half()) for weight in weights])
    # (w - 1) / (w + 1): -1, -0.82, -0.33, 0, 0.33, 0.82, 1
    assert tuning(atoms, 1.0).binocularity_counts().tolist() == [1] * 7


def test_the_share_of_an_eye_weighs_atoms_by_their_part_in_the_code():
    only_left, only_right = atom(half(), 0 * half()), atom(0 * half(), half())
    balanced = atom(half(), half())
    atoms = np.stack([only_left, only_right, balanced])
    assert left_share(np.array([3.0, 1.0, 0.0]), atoms) == pytest.approx(0.75)
    assert left_share(np.array([0.0, 0.0, 5.0]), atoms) == pytest.approx(0.5)
    assert left_share(np.array([1.0, 0.0, 1.0]), atoms) == pytest.approx(0.75)
    assert np.isnan(left_share(np.zeros(3), atoms))


def test_both_scales_have_one_share():
    atoms = np.stack([[atom(half(), 0 * half())], [atom(0 * half(), half())]])
    assert left_share(np.array([[3.0], [1.0]]), atoms) == pytest.approx(0.75)
