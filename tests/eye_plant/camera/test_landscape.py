import numpy as np

from eye_plant.camera.landscape import landscape_picture


def test_the_landscape_is_a_function_of_its_seed() -> None:
    first, other = landscape_picture(0), landscape_picture(1)  # which takes the first's memory
    np.testing.assert_array_equal(landscape_picture(0), first)
    assert (other != first).mean() > 0.5


def test_no_part_of_the_landscape_is_even() -> None:
    picture = landscape_picture(0)
    assert picture.dtype == np.uint8
    tiles = picture.reshape(10, 80, 26, 100)  # 1.2 m x 1.5 m each
    assert tiles.std(axis=(1, 3)).min() > 5.0
