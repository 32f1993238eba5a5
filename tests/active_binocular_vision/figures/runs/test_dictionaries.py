"""Each basis function is a tile, in the order of preferred disparity."""

import numpy as np
import pytest

from active_binocular_vision.figures.runs.dictionaries import dictionary_figure
from lockstep import InputError
from lockstep.scales import ScalesConfig
from tests.active_binocular_vision.learners.gabor_patch import atom, gabor_patch, shifted_wave


def test_both_scales_show_the_atoms_that_prefer_a_disparity_first() -> None:
    one_eyed = atom(gabor_patch(), 0.0 * gabor_patch())
    atoms = np.stack([shifted_wave(2.0), one_eyed, shifted_wave(-1.0), shifted_wave(0.5)])
    figure = dictionary_figure(np.stack([atoms, atoms]))
    for axes in figure.axes[:2]:
        mosaic = np.asarray(axes.images[0].get_array())
        for i, shown in enumerate((2, 3, 0, 1)):
            left = mosaic[1:9, 19 * i + 2 : 19 * i + 10]
            expected = atoms[shown, :64].reshape(8, 8) / np.abs(atoms[shown]).max()
            np.testing.assert_allclose(left, expected)
    for histogram, scale in zip(figure.axes[2:], ScalesConfig().all, strict=True):
        assert "the 3 of" in histogram.get_title("left")
        boxes = [bar.get_window_extent() for bar in histogram.patches]
        middles_px = [box.x0 + box.width / 2.0 for box in boxes if box.height]
        pixels = [(x, 0.0) for x in middles_px]
        middles = histogram.transData.inverted().transform(pixels)[:, 0]
        np.testing.assert_allclose(
            np.divide(middles, scale.px_per_pixel), [-1.0, 0.5, 2.0], atol=0.15
        )


@pytest.mark.filterwarnings("error")
def test_each_atom_becomes_one_tile() -> None:
    atoms = np.zeros((2, 20, 128), np.float32)
    atoms[0, 7, :64] = 2.0
    figure = dictionary_figure(atoms)
    mosaic = np.asarray(figure.axes[0].images[0].get_array())
    assert mosaic.shape == (2 * 9 + 1, 16 * 19 + 1)
    # None prefers anything, and what only one eye sees comes last: the fourth of the second row.
    first = 3 * 19 + 2
    assert (mosaic[10:18, first : first + 8] == 1.0).all(), "the left eye's part"
    assert (mosaic[10:18, first + 8 : first + 16] == 0.0).all(), "the right eye's"
    assert (mosaic[1:9, 2:18] == 0.0).all()
    with pytest.raises(InputError, match=r"expected atoms \(2, n_bases, 128\), got shape \(3, 4\)"):
        dictionary_figure(np.zeros((3, 4)))
