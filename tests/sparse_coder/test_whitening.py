import numpy as np
from numpy.typing import NDArray

from sparse_coder.whitening import GAIN, KERNEL, whitened


def slow_whitened(window: NDArray) -> NDArray[np.float64]:
    """Return the window filtered pixel by pixel, mirrored beyond its border."""
    around = np.pad(window.astype(np.float64), 7, mode="symmetric")
    places = range(len(window))
    return np.array(
        [[(KERNEL * around[y : y + 15, x : x + 15]).sum() for x in places] for y in places]
    )


def test_windows_match_a_slow_filter(picture: NDArray[np.uint8]) -> None:
    window = picture[:40, :40].astype(np.float32)
    np.testing.assert_allclose(whitened(window), slow_whitened(window), atol=1e-3)


def test_an_even_window_becomes_0() -> None:
    even = np.full((32, 32), 200.0, np.float32)
    np.testing.assert_allclose(whitened(even), 0.0, atol=1e-3)


def test_waves_are_passed_by_their_frequency() -> None:
    """The gain of a wave of f cycles per pixel is near |f| exp(-(f / 0.4)^4)."""
    x = np.arange(256)
    for f in (1 / 16, 1 / 8, 1 / 4):
        wave = np.tile(np.sin(2.0 * np.pi * f * x), (256, 1)).astype(np.float32)
        middle = whitened(wave)[64:192, 64:192]
        gain = middle.std() / wave[64:192, 64:192].std()
        np.testing.assert_allclose(gain, f * np.exp(-((f / 0.4) ** 4)), rtol=0.1)


def test_white_noise_keeps_the_gain_of_its_standard_deviation() -> None:
    noise = np.random.default_rng(4).standard_normal((400, 400)).astype(np.float32)
    np.testing.assert_allclose(whitened(noise).std(), GAIN, rtol=0.01)
