"""What the basis functions of a dictionary are tuned to: orientation, eye, disparity.

Dimensions: n_bases atoms of one scale, (n_bases, 128): the left eye's 64 pixels, then the right's.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.learners.gabor import GOOD_RESIDUAL, Gabors, fit_gabors
from lockstep import InputError
from lockstep.scales import ScalesConfig
from sparse_coder.patches import N_PIXELS

Array = NDArray[np.float64]

_SCALES = ScalesConfig()

# Edges of the seven bins of ocular dominance, from the left eye alone to the right eye alone
# (Klimmasch et al. 2021, after Hubel & Wiesel 1962).
BINOCULARITY_EDGES = np.array([-1.0, -0.85, -0.5, -0.15, 0.15, 0.5, 0.85, 1.0])
ORIENTATION_STEP_DEG = 22.5
# Beyond it, measured from the vertical, stripes are so near the horizontal that a shift along the
# row hardly changes the phase.
_LARGEST_TILT_DEG = 67.5
# An atom that is nearly all of one eye has no disparity.
_LARGEST_DOMINANCE = 0.85
# Beyond half a patch the overlap of both halves is too small to distinguish a match from chance.
LARGEST_SHIFT_PX = 4.0


@dataclass(frozen=True)
class Tuning:
    """What the atoms of one scale are tuned to; each array is (n_bases,).

    The dominant eye is the one whose half answers more strongly to the Gabor function fitted to it
    alone. residual: squared residuals of that fit, as a share of the squared entries of the whole
    atom; is_gabor: whether they are at most 0.2, so that the atom counts (Klimmasch et al. 2021,
    who take the left half). is_common_gabor: the same for one function fitted to both halves.
    orientation_deg: of the dominant eye's stripes, 0 horizontal, 90 vertical; wavelength_px: of
    these in pixels of the picture. binocularity: (R - L) / (R + L), -1 is left alone, 1 right
    alone; R and L are the halves' responses to the dominant eye's function, as in their public
    code, so that a shift by a quarter of a wave between the eyes counts as monocular. disparity_px:
    preferred disparity in pixels of the picture, left minus right as
    eye_plant.vergence.disparity_px has it; nan where an atom has none.
    """

    residual: Array
    is_gabor: NDArray[np.bool_]
    is_common_gabor: NDArray[np.bool_]
    orientation_deg: Array
    wavelength_px: Array
    binocularity: Array
    disparity_px: Array

    @property
    def binocular_share(self) -> float:
        """Share of the Gabor atoms with |binocularity| below 0.5; nan where there are none."""
        counts = self.binocularity_counts()
        return float(counts[2:5].sum() / counts.sum()) if counts.any() else float("nan")

    def orientation_counts(self) -> NDArray[np.int64]:
        """Return the Gabor atoms in eight bins, the first one centred on 0 deg, horizontal."""
        n_bins = round(180.0 / ORIENTATION_STEP_DEG)
        bins = np.round(self.orientation_deg[self.is_gabor] / ORIENTATION_STEP_DEG) % n_bins
        return np.bincount(bins.astype(int), minlength=n_bins)

    def binocularity_counts(self) -> NDArray[np.int64]:
        """Return the Gabor atoms in the seven bins between BINOCULARITY_EDGES, left to right."""
        return np.histogram(self.binocularity[self.is_gabor], BINOCULARITY_EDGES)[0]


def tunings(atoms: NDArray[Any], scales: ScalesConfig = _SCALES) -> tuple[Tuning, ...]:
    """Return what the atoms (n_scales, n_bases, 128) of each scale are tuned to."""
    return tuple(
        tuning(of_scale.astype(np.float64), scale.px_per_pixel)
        for of_scale, scale in zip(atoms, scales.all, strict=True)
    )


def tuning(atoms: Array, px_per_pixel: float) -> Tuning:
    """Return what the atoms (n_bases, 128) of a scale are tuned to.

    px_per_pixel: pixels of the picture in one of the scale.
    """
    halves = _halves(atoms)
    alone = fit_gabors(halves.reshape(2 * len(atoms), 1, -1))
    functions = alone.patches.reshape(halves.shape)
    dominant = (functions * halves).sum(axis=2).argmax(axis=1)
    every = np.arange(len(atoms))
    responses = np.abs((functions[every, dominant, None] * halves).sum(axis=2))
    residual = _residual_of_half(alone, halves)[every, dominant]
    common = fit_gabors(halves)
    return Tuning(
        residual=residual,
        is_gabor=residual <= GOOD_RESIDUAL,
        is_common_gabor=common.is_good,
        orientation_deg=alone.orientation_deg.reshape(-1, 2)[every, dominant],
        wavelength_px=alone.wavelength_px.reshape(-1, 2)[every, dominant] * px_per_pixel,
        binocularity=_balance(responses),
        disparity_px=_disparity(common, halves) * px_per_pixel,
    )


def preferred_disparity_px(atoms: NDArray[Any], px_per_pixel: float) -> Array:
    """Return disparity_px of Tuning alone, for which one fit to each atom is enough."""
    halves = _halves(atoms)
    return _disparity(fit_gabors(halves), halves) * px_per_pixel


def dominance(atoms: NDArray[Any]) -> Array:
    """Return (R - L) / (R + L) of the norms of both halves: -1 is left alone, 1 right alone."""
    return _balance(np.linalg.norm(_halves(atoms), axis=2))


def _halves(atoms: NDArray[Any]) -> Array:
    if atoms.ndim != 2 or atoms.shape[1] != N_PIXELS:
        raise InputError(f"expected atoms (n_bases, {N_PIXELS}), got shape {atoms.shape}")
    return atoms.astype(np.float64).reshape(len(atoms), 2, -1)


def _balance(of_eyes: Array) -> Array:
    """Return (R - L) / (R + L) of an amount (n, 2) per eye; 0 where both have none."""
    left, right = of_eyes.T
    both = left + right
    return (right - left) / np.where(both > 0.0, both, 1.0)


def _residual_of_half(alone: Gabors, halves: Array) -> Array:
    """Return what fits of halves (n, 2, 64) leave, as shares of the whole atoms' energy, (n, 2)."""
    energy = (halves**2).sum(axis=2)
    whole = energy.sum(axis=1, keepdims=True)
    share: Array = alone.residual.reshape(-1, 2) * energy / np.where(whole > 0.0, whole, 1.0)
    return np.where(whole > 0.0, share, 1.0)


def _disparity(common: Gabors, halves: Array) -> Array:
    """Return the shift along the row of the left half's pattern against the right's, (n,) pixels.

    d = (phase_R - phase_L) wavelength / (2 pi cos(theta)), theta the wave's angle and the phase
    difference the one nearest to 0 (Klimmasch et al. 2021, with our sign: positive where the eyes
    converge too little). nan where an atom (n, 2, 64) has none.
    """
    difference = common.phase_rad[:, 1] - common.phase_rad[:, 0]
    nearest = np.mod(difference + np.pi, 2.0 * np.pi) - np.pi
    is_upright = np.abs(common.wave_angle_deg) <= _LARGEST_TILT_DEG
    cosine = np.cos(np.radians(np.where(is_upright, common.wave_angle_deg, 0.0)))
    shift_px = nearest * common.wavelength_px / (2.0 * np.pi) / cosine
    is_known = (
        common.is_good
        & is_upright
        & (np.abs(_balance(np.linalg.norm(halves, axis=2))) < _LARGEST_DOMINANCE)
        & (np.abs(shift_px) <= LARGEST_SHIFT_PX)
    )
    return np.where(is_known, shift_px, np.nan)


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
