"""Pictures, patches and the slow, obvious matching pursuit that the fast one is held against."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

Pursuit = Callable[
    [NDArray[np.float32], NDArray[np.float32], int], tuple[list[list[int]], NDArray[np.float64]]
]


@pytest.fixture
def brute_force_pursuit() -> Pursuit:
    """Matching pursuit in float64, one residual at a time, without a Gram matrix.

    Returns the selected atoms of each patch and the residuals (n_patches, n_pixels).
    """

    def pursue(
        patches: NDArray[np.float32], atoms: NDArray[np.float32], n_selections: int
    ) -> tuple[list[list[int]], NDArray[np.float64]]:
        selected, residuals = [], []
        for patch in patches.astype(np.float64):
            residual, chosen = patch.copy(), []
            for _ in range(n_selections):
                correlations = [float(atom.astype(np.float64) @ residual) for atom in atoms]
                k = int(np.argmax(np.abs(correlations)))
                residual = residual - correlations[k] * atoms[k].astype(np.float64)
                chosen.append(k)
            selected.append(chosen)
            residuals.append(residual)
        return selected, np.array(residuals)

    return pursue


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
