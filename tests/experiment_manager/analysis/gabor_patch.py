"""Gabor functions as their formula has them."""

import numpy as np


def gabor_patch(
    *,
    wave_angle_deg: float,
    wavelength_px: float,
    x_px: float,
    y_px: float,
    width_px: float,
    length_px: float,
    phase_rad: float,
) -> np.ndarray:
    """Return the pixels (64,), row by row from the top, of a Gabor function of amplitude 1."""
    theta = np.radians(wave_angle_deg)
    row, column = np.mgrid[:8, :8].reshape(2, 64)
    x, y = column - 3.5, 3.5 - row
    across = (x - x_px) * np.cos(theta) + (y - y_px) * np.sin(theta)
    along = (y - y_px) * np.cos(theta) - (x - x_px) * np.sin(theta)
    envelope = np.exp(-(across**2) / (2 * width_px**2) - along**2 / (2 * length_px**2))
    patch: np.ndarray = envelope * np.cos(2 * np.pi * across / wavelength_px + phase_rad)
    return patch
