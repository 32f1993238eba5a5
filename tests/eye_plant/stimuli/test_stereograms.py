import cv2
import numpy as np
import pytest

from eye_plant.stimuli.stereograms import random_dot_stereograms, read_stereograms
from lockstep import InputError


def test_both_eyes_have_the_same_dots_shifted_by_the_parallax():
    for stereogram in random_dot_stereograms(seed=3, n=12, size_px=400):
        shift_px = round(stereogram.parallax * 400)
        assert abs(shift_px) <= 3
        here, there = max(shift_px, 0), max(-shift_px, 0)
        n_common = 400 - abs(shift_px)
        assert (
            stereogram.left[:, here : here + n_common]
            == stereogram.right[:, there : there + n_common]
        ).all()


def test_shifts_of_both_signs_and_fair_dots():
    stereograms = random_dot_stereograms(seed=1, n=20, size_px=1920)
    parallaxes = np.array([stereogram.parallax for stereogram in stereograms])
    assert parallaxes.min() < 0.0 < parallaxes.max()
    assert np.abs(parallaxes).max() <= 0.0075
    for stereogram in stereograms:
        assert set(np.unique(stereogram.left)) == {32, 224}
        assert 0.45 < (stereogram.left == 32).mean() < 0.55


def test_stereograms_are_a_function_of_the_seed():
    (first, again), (other, _) = (random_dot_stereograms(seed, 2, 80) for seed in (1, 2))
    assert (random_dot_stereograms(1, 1, 80)[0].left == first.left).all()
    assert (first.left != again.left).any()
    assert (first.left != other.left).any()


def write(path, shape, grey=100):
    picture = np.full(shape, grey, np.uint8)
    picture[shape[0] // 2 :] = 255 - grey
    cv2.imwrite(str(path), picture)


def test_pairs_of_files_are_stereograms(tmp_path):
    for name in ("b", "a"):
        write(tmp_path / f"{name}_left.png", (90, 90), 50)
        write(tmp_path / f"{name}_right.png", (90, 90), 200)
    found = read_stereograms(str(tmp_path), 0, 10, 64, 64)
    assert len(found) == 2
    assert found[0].left.shape == (64, 64)
    assert (found[0].left[0, 0], found[0].right[0, 0], found[0].parallax) == (50, 200, 0.0)
    assert len(read_stereograms(str(tmp_path), 0, 1, 64, 64)) == 1


@pytest.mark.parametrize(
    ("widths_px", "message"),
    [
        ({"a_left": 90, "a_right": 120}, r"a_right.png: expected .* 90 x 90 px.* got 120 x 90 px"),
        ({"a_left": 90}, "expected a_right beside the other eye's"),
        ({"left": 90}, "a name that ends in _left or _right"),
    ],
)
def test_files_that_make_no_stereograms_are_refused(tmp_path, widths_px, message):
    for name, width_px in widths_px.items():
        write(tmp_path / f"{name}.png", (90, width_px))
    with pytest.raises(InputError, match=message):
        read_stereograms(str(tmp_path), 0, 10, 64, 64)
