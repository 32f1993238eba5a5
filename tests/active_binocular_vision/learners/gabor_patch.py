"""Gabor functions as their formula has them, and atoms of two of them."""

import numpy as np


def gabor_patch(
    *,
    wave_angle_deg: float = 0.0,
    wavelength_px: float = 6.0,
    x_px: float = 0.0,
    y_px: float = 0.0,
    width_px: float = 1.8,
    length_px: float = 2.5,
    phase_rad: float = 0.0,
) -> np.ndarray:
    """Return the pixels (64,), row by row from the top, of a Gabor function of amplitude 1."""
    theta = np.radians(wave_angle_deg)
    row, column = np.mgrid[:8, :8].reshape(2, 64)
    x, y = column - 3.5, 3.5 - row
    across = (x - x_px) * np.cos(theta) + (y - y_px) * np.sin(theta)
    along = (y - y_px) * np.cos(theta) - (x - x_px) * np.sin(theta)
    envelope = np.exp(-(across**2) / (2 * width_px**2) - along**2 / (2 * length_px**2))
    return envelope * np.cos(2 * np.pi * across / wavelength_px + phase_rad)


def atom(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Return a unit atom (128,) of both eyes' halves."""
    both = np.concatenate([left, right])
    return both / np.linalg.norm(both)


def shifted_wave(
    shift_px: float, wave_angle_deg: float = 0.0, wavelength_px: float = 6.0
) -> np.ndarray:
    """Both eyes under one envelope, the left eye's wave moved right by shift_px."""
    along_px = shift_px * np.cos(np.radians(wave_angle_deg))
    phase_rad = -2.0 * np.pi * along_px / wavelength_px
    wave = {"wave_angle_deg": wave_angle_deg, "wavelength_px": wavelength_px}
    return atom(*(gabor_patch(**wave, phase_rad=p) for p in (phase_rad, 0.0)))
