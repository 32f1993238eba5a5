import numpy as np
import pytest
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.scales import ScalesConfig
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.patches import binocular_patches
from sparse_coder.whitening import whitened
from sparse_coder.windows import windows_of

Pair = tuple[NDArray[np.uint8], NDArray[np.uint8]]

THREE = ScalesConfig(
    names=("coarse", "fine", "foveal"),
    window_px=(128, 40, 40),
    size_px=(32, 40, 40),
    zoom=(1.0, 1.0, 4.0),
    focus_d=(0.0, 0.0, 0.0),
)


@pytest.fixture
def foveal(stereo_pair: Pair) -> NDArray[np.uint8]:
    return np.stack([picture[:40, :40] for picture in stereo_pair])


def test_a_scale_apart_is_cut_from_its_own_pictures(
    stereo_pair: Pair, foveal: NDArray[np.uint8]
) -> None:
    windows = windows_of(*stereo_pair, [foveal], THREE)
    assert [pair[0].shape for pair in windows] == [(32, 32), (40, 40), (40, 40)]
    for pair, alone in zip(windows[:2], windows_of(*stereo_pair), strict=True):
        np.testing.assert_array_equal(pair, alone)
    np.testing.assert_array_equal(windows[2], foveal)


def test_windows_for_lenses_are_whitened(stereo_pair: Pair) -> None:
    first, last = windows_of(*stereo_pair, scales=ScalesConfig(n_for_lenses=1))
    plain = windows_of(*stereo_pair)
    np.testing.assert_array_equal(first, plain[0])
    np.testing.assert_array_equal(last, [whitened(window) for window in plain[1]])


def test_a_scale_is_left_for_the_eyes() -> None:
    with pytest.raises(InputError, match=r"n_for_lenses: expected less than 2 \(scales\), got 2"):
        ScalesConfig(n_for_lenses=2)


def test_three_scales_are_coded_and_learned(stereo_pair: Pair, foveal: NDArray[np.uint8]) -> None:
    coder = SparseCoder(SparseCoderConfig(n_bases=40, n_selections=5, scales=THREE))
    first = coder.encode(*stereo_pair, [foveal])
    assert first.features.shape == (3, 40)
    expected = binocular_patches(*(picture.astype(np.float32) for picture in foveal))
    np.testing.assert_array_equal(first.patches[2], expected)
    for _ in range(50):
        coder.learn(coder.encode(*stereo_pair, [foveal]))
    errors = coder.encode(*stereo_pair, [foveal]).reconstruction_error
    assert (errors < 0.8 * first.reconstruction_error).all()
    percept = coder.perceive(*stereo_pair, np.zeros(4), apart=[foveal])
    assert percept.reward == pytest.approx(-errors.sum())
    assert len(percept.reward_values()) == 7


def test_the_first_scales_do_not_depend_on_further_ones(
    stereo_pair: Pair, foveal: NDArray[np.uint8]
) -> None:
    two = SparseCoder(SparseCoderConfig(n_bases=40)).encode(*stereo_pair)
    config = SparseCoderConfig(n_bases=40, scales=THREE)
    three = SparseCoder(config).encode(*stereo_pair, [foveal])
    np.testing.assert_array_equal(three.features[:2], two.features)


def test_missing_and_wrong_pictures_of_scales_are_refused(
    stereo_pair: Pair, foveal: NDArray[np.uint8]
) -> None:
    coder = SparseCoder(SparseCoderConfig(n_bases=40, scales=THREE))
    with pytest.raises(
        InputError, match="pictures of scales apart: expected those of foveal, got 0"
    ):
        coder.encode(*stereo_pair)
    with pytest.raises(InputError, match="pictures of scales apart: expected those of none, got 1"):
        SparseCoder(SparseCoderConfig(n_bases=40)).encode(*stereo_pair, [foveal])
    with pytest.raises(InputError, match="even sides of at least 40 px, got height 38"):
        coder.encode(*stereo_pair, [foveal[:, :38]])
    with pytest.raises(InputError, match="foveal pictures: expected two"):
        coder.encode(*stereo_pair, [foveal[:1]])
