import numpy as np
import pytest

from active_binocular_vision.baselines.energy_model import (
    N_LEVELS,
    N_ORIENTATIONS,
    N_PHASES,
    WAVELENGTH_PX,
    gabors,
    phase_differences,
    population,
)

SIDE_PX = 128
ACROSS, DOWN = 0, N_ORIENTATIONS // 2


def grating(shift_px: float, axis: int, wavelength_px: float = WAVELENGTH_PX) -> np.ndarray:
    """Stripes of a sine wave along an axis of the picture, moved so far to the right or down."""
    along = np.arange(SIDE_PX) - shift_px
    sine = np.sin(2.0 * np.pi * along / wavelength_px)
    wave = np.round(128.0 + 100.0 * sine).astype(np.uint8)
    return np.tile(wave, (SIDE_PX, 1)) if axis == 1 else np.tile(wave[:, None], (1, SIDE_PX))


@pytest.mark.parametrize("shift_px", [0.0, 0.5, 1.0, -1.5])
@pytest.mark.parametrize(("axis", "orientation"), [(1, ACROSS), (0, DOWN)])
def test_a_cell_responds_as_a_cosine_of_its_phase_and_the_shift(axis, orientation, shift_px):
    # R = L exp(i k d), so |L exp(i p) + R|^2 = 2 |L|^2 (1 + cos(p - k d)).
    cells = population(grating(0.0, axis), grating(shift_px, axis))[0, orientation]
    expected = 1.0 + np.cos(phase_differences() - 2.0 * np.pi * shift_px / WAVELENGTH_PX)
    np.testing.assert_allclose(cells / cells.sum(), expected / expected.sum(), atol=2e-3)


def test_each_level_has_twice_the_wavelength():
    wide = 4.0 * WAVELENGTH_PX
    cells = population(grating(0.0, 1, wide), grating(4.0, 1, wide))[2, ACROSS]
    # 4 px of 24: as 1 px of 6, so that the cell next to 2 pi / 6 responds most.
    assert int(np.argmax(cells)) == round(N_PHASES / 6)


def test_stripes_along_a_shift_do_not_show_it():
    moved = np.roll(grating(0.0, 1), 3, axis=0)
    np.testing.assert_array_equal(
        population(grating(0.0, 1), moved), population(grating(0.0, 1), grating(0.0, 1))
    )


def test_energies_are_sums_of_squares_of_simple_cells():
    draw = np.random.default_rng(2)
    left, right = draw.integers(0, 256, (2, SIDE_PX, SIDE_PX), np.uint8)
    gabor = gabors()[3]
    half = len(gabor) // 2
    y, x = np.mgrid[:SIDE_PX, :SIDE_PX] - (SIDE_PX - 1) / 2.0
    pool = np.exp(-(x**2 + y**2) / (2.0 * 8.0**2))
    padded = [np.pad(eye.astype(float), half, mode="reflect") for eye in (left, right)]
    found = np.zeros(N_PHASES)
    inner = slice(SIDE_PX // 2 - 28, SIDE_PX // 2 + 28)  # beyond it the pool has 0.2 %
    for row in range(SIDE_PX)[inner]:
        for column in range(SIDE_PX)[inner]:
            of_left, of_right = (
                (eye[row : row + len(gabor), column : column + len(gabor)] * gabor).sum()
                for eye in padded
            )
            simple = of_left * np.exp(1j * phase_differences()) + of_right
            found += pool[row, column] * (simple.real**2 + simple.imag**2)
    cells = population(left, right)[0, 3]
    np.testing.assert_allclose(found / found.sum(), cells / cells.sum(), rtol=0.01)


def test_uniform_pictures_excite_no_cell_and_contrast_does_not_count():
    grey = np.full((SIDE_PX, SIDE_PX), 90, np.uint8)
    assert population(grey, grey).shape == (N_LEVELS, N_ORIENTATIONS, N_PHASES)
    assert not population(grey, grey).any()
    left, right = np.random.default_rng(3).integers(0, 120, (2, SIDE_PX, SIDE_PX), np.uint8)
    np.testing.assert_allclose(population(left, right), population(2 * left, 2 * right), rtol=1e-5)
