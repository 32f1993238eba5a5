"""A binocular energy model with fixed Gabor filters, read out to vergence.

Ohzawa, DeAngelis & Freeman 1990; for vergence Gibaldi et al. 2010 (without explicit disparity) and
2017 (horizontal and vertical, on a robot): complex cells of several orientations and differences of
phase between the eyes, at several scales; their responses about the fovea are pooled, divided by
those of the whole population, and weighted linearly. Ours: the pyramid's number of levels, which
covers the first errors of a run, and weights that are calibrated on pictures of known errors.

Dimensions: n_levels, n_orientations, n_phases.
"""

from functools import cache

import cv2
import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.baselines.bench import Seen

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]
Picture = NDArray[np.float32]

N_LEVELS, N_ORIENTATIONS, N_PHASES = 4, 8, 7
# Of a level: one octave wide, so that SD = 0.56 wavelength, and as many pixels as hold 3 SD.
WAVELENGTH_PX = 6.0
_SD_PX = 0.56 * WAVELENGTH_PX
_HALF_PX = 10
# Of a level's picture, about its centre.
_POOLED_SD_PX = 8.0
# In squares of grey levels: less is rounding.
_LEAST_ENERGY = 1e-6


@cache
def gabors() -> tuple[Complex, ...]:
    """Return the quadrature pairs exp(-r^2 / 2 SD^2) exp(i k x) of each orientation, without mean.

    The wave of orientation j runs along the angle pi j / n_orientations from the row's direction.
    """
    y, x = np.mgrid[-_HALF_PX : _HALF_PX + 1, -_HALF_PX : _HALF_PX + 1].astype(np.float64)
    envelope = np.exp(-(x**2 + y**2) / (2.0 * _SD_PX**2))
    envelope /= envelope.sum()
    found = []
    for angle in np.pi * np.arange(N_ORIENTATIONS) / N_ORIENTATIONS:
        along = x * np.cos(angle) + y * np.sin(angle)
        wave = np.exp(2j * np.pi * along / WAVELENGTH_PX)
        found.append(envelope * (wave - (envelope * wave).sum()))
    return tuple(found)


def phase_differences() -> Array:
    """Return the difference between the eyes' phases of each cell, (n_phases,), from 0 up."""
    return 2.0 * np.pi * np.arange(N_PHASES) / N_PHASES


def population(left: NDArray[np.uint8], right: NDArray[np.uint8]) -> Array:
    """Return the responses (n_levels, n_orientations, n_phases) to two pictures (height, width).

    Of a level the mean is 1, unless its pictures are uniform, where all are 0.
    """
    pictures = [np.asarray(picture, np.float32) for picture in (left, right)]
    levels = []
    for _ in range(N_LEVELS):
        levels.append(_level(*pictures))
        pictures = [np.asarray(cv2.pyrDown(picture), np.float32) for picture in pictures]
    return np.stack(levels)


def _level(left: Picture, right: Picture) -> Array:
    """Return the pooled energies |L exp(i p) + R|^2, (n_orientations, n_phases), of mean 1.

    A pattern that the right eye has d px further along the wave than the left one gives R = L exp(i
    k d), k = 2 pi / wavelength: the cell with p = k d responds most.
    """
    pool = _pool(left.shape)
    shifted = np.exp(-1j * phase_differences())
    energies = []
    for gabor in gabors():
        of_left, of_right = (_filtered(eye, gabor) for eye in (left, right))
        both = (pool * (np.abs(of_left) ** 2 + np.abs(of_right) ** 2)).sum()
        product = (pool * np.conj(of_left) * of_right).sum()
        energies.append(both + 2.0 * (product * shifted).real)
    mean = float(np.mean(energies))
    return np.array(energies) / mean if mean > _LEAST_ENERGY else np.zeros_like(energies)


def _filtered(eye: Picture, gabor: Complex) -> Complex:
    real, imaginary = (
        cv2.filter2D(eye, cv2.CV_32F, part, borderType=cv2.BORDER_REFLECT)
        for part in (gabor.real, gabor.imag)
    )
    return np.asarray(real + 1j * imaginary)


@cache
def _pool(shape: tuple[int, int]) -> Array:
    y, x = (np.arange(n) - (n - 1) / 2.0 for n in shape)
    pool = np.exp(-(y[:, None] ** 2 + x**2) / (2.0 * _POOLED_SD_PX**2))
    return pool / pool.sum()


def entries(seen: Seen) -> Array:
    """Return the responses of the whole population to what is seen, (n,)."""
    return population(*seen.pictures).ravel()
