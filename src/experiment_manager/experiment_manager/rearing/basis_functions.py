"""What the basis functions of a dictionary are tuned to: orientation, eye, disparity.

Dimensions: n_bases atoms of one scale, (n_bases, 128): the left eye's 64 pixels, then the right's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiment_manager.rearing.gabor import Gabors, fit_gabors
from eye_plant.geometry import degrees_per_px
from lockstep.errors import InputError
from sparse_coder.patches import N_PIXELS

Array = NDArray[np.float64]

# Edges of the seven bins of ocular dominance, from the left eye alone to the right eye alone
# (Klimmasch et al. 2021, after Hubel & Wiesel 1962).
BINOCULARITY_EDGES = np.array([-1.0, -0.85, -0.5, -0.15, 0.15, 0.5, 0.85, 1.0])
ORIENTATION_STEP_DEG = 22.5
# Beyond it, measured from the vertical, stripes are so near the horizontal that a shift along the
# row is hardly told by a phase.
_LARGEST_TILT_DEG = 67.5
# What is left of one eye in a cell that the other dominates tells no disparity.
_LARGEST_DOMINANCE = 0.85


@dataclass(frozen=True)
class Tuning:
    """What the atoms of one scale are tuned to; each array is (n_bases,).

    residual: what a Gabor function common to both eyes leaves of an atom, as a share. is_gabor:
    whether that is at most 0.2, the only atoms of which the others tell something.
    orientation_deg: of the stripes, 0 horizontal, 90 vertical. binocularity: (R - L) / (R + L), -1
    is left alone, 1 right alone. disparity_px: preferred disparity in pixels of the picture, left
    minus right as eye_plant.geometry.disparity_px has it; nan where an atom tells none.
    """

    residual: Array
    is_gabor: NDArray[np.bool_]
    orientation_deg: Array
    binocularity: Array
    disparity_px: Array

    @property
    def gabor_share(self) -> float:
        """Share of the atoms that are Gabor functions."""
        return float(self.is_gabor.mean())

    def orientation_counts(self) -> NDArray[np.int64]:
        """Return the Gabor atoms in eight bins, the first one centred on 0 deg, horizontal."""
        n_bins = round(180.0 / ORIENTATION_STEP_DEG)
        bins = np.round(self.orientation_deg[self.is_gabor] / ORIENTATION_STEP_DEG) % n_bins
        return np.bincount(bins.astype(int), minlength=n_bins)

    def binocularity_counts(self) -> NDArray[np.int64]:
        """Return all atoms in the seven bins between BINOCULARITY_EDGES, left to right."""
        return np.histogram(self.binocularity, BINOCULARITY_EDGES)[0]

    def disparities_deg(self, focal_length_px: float) -> Array:
        """Return the preferred disparities of the atoms that have one, as angles at the centre."""
        told = self.disparity_px[~np.isnan(self.disparity_px)]
        return told * degrees_per_px(focal_length_px)


def tuning(atoms: Array, px_per_pixel: float) -> Tuning:
    """Return what the atoms (n_bases, 128) of a scale are tuned to.

    px_per_pixel: pixels of the picture in one of the scale.
    """
    if atoms.ndim != 2 or atoms.shape[1] != N_PIXELS:
        raise InputError(f"expected atoms (n_bases, {N_PIXELS}), got shape {atoms.shape}")
    gabors = fit_gabors(atoms.reshape(len(atoms), 2, -1))
    binocularity = binocularity_of(atoms)
    told = gabors.is_good & (np.abs(binocularity) < _LARGEST_DOMINANCE)
    disparity_px = np.where(told, preferred_disparity_px(gabors), np.nan) * px_per_pixel
    return Tuning(
        residual=gabors.residual,
        is_gabor=gabors.is_good,
        orientation_deg=gabors.orientation_deg,
        binocularity=binocularity,
        disparity_px=disparity_px,
    )


def binocularity_of(atoms: Array) -> Array:
    """Return (R - L) / (R + L) of atoms (n_bases, 128), R and L the norms of the eyes' halves."""
    left, right = (
        np.linalg.norm(half, axis=1) for half in np.split(atoms.astype(np.float64), 2, axis=1)
    )
    both = left + right
    balance: Array = (right - left) / np.where(both > 0.0, both, 1.0)
    return balance


def preferred_disparity_px(gabors: Gabors) -> Array:
    """Return the shift along the row of the left eye's pattern against the right's, (n,) pixels.

    d = (phase_R - phase_L) wavelength / (2 pi cos(theta)), theta the wave's angle and the phase
    difference the one nearest to 0 (Klimmasch et al. 2021, with our sign: positive where the eyes
    converge too little). nan where the stripes are too near the horizontal.
    """
    if gabors.phase_rad.shape[1] != 2:
        raise InputError(f"expected fits of both eyes, got {gabors.phase_rad.shape[1]} eye")
    difference = gabors.phase_rad[:, 1] - gabors.phase_rad[:, 0]
    nearest = np.mod(difference + np.pi, 2.0 * np.pi) - np.pi
    shift_px = nearest * gabors.wavelength_px / (2.0 * np.pi)
    told = np.abs(gabors.wave_angle_deg) <= _LARGEST_TILT_DEG
    cosine = np.cos(np.radians(np.where(told, gabors.wave_angle_deg, 0.0)))
    return np.where(told, shift_px / cosine, np.nan)


def left_share(features: NDArray[Any], atoms: NDArray[Any]) -> float:
    """Return the left eye's share of a code, 0.5 where neither eye is suppressed.

    sum_k f_k |l_k|^2 / sum_k f_k |a_k|^2: f the features (..., n_bases), an atom's mean squared
    coefficient; l_k the left half of atom a_k of atoms (..., n_bases, 128). Leading dimensions are
    summed over, so both scales together have one share; nan for an empty code.
    """
    energy = atoms.astype(np.float64) ** 2
    n_left = energy.shape[-1] // 2
    weights = np.asarray(features, dtype=np.float64)
    left = (weights * energy[..., :n_left].sum(axis=-1)).sum()
    whole = (weights * energy.sum(axis=-1)).sum()
    return float(left / whole) if whole > 0.0 else float("nan")
