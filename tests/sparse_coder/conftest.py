"""Pictures of a small scene."""

import numpy as np
import pytest
from numpy.typing import NDArray


@pytest.fixture
def picture() -> NDArray[np.uint8]:
    """A grey scene of 260 x 340 px with a 1/f spectrum and an occluding edge."""
    draw = np.random.default_rng(5)
    height, width = 260, 340
    frequency = np.hypot(np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None, :])
    frequency[0, 0] = 1.0
    spectrum = draw.standard_normal(frequency.shape) + 1j * draw.standard_normal(frequency.shape)
    scene = np.fft.irfft2(spectrum / frequency, s=(height, width))
    scene[:, 180:] += 2.0 * scene.std()
    scene = 255.0 * (scene - scene.min()) / np.ptp(scene)
    return scene.astype(np.uint8)


@pytest.fixture
def stereo_pair(picture: NDArray[np.uint8]) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Two 240 x 320 pictures of the scene, shifted by 3 px against each other."""
    return picture[10:250, 10:330], picture[10:250, 13:333]
