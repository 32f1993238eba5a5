"""Acuity: how fine a grating the code of one eye's picture still explains.

A grating of full contrast fills the picture of one eye; the other one sees black. Explained is the
share of the energy of the sharp grating's patches that the finest scale's code of the seen picture
accounts for. Acuity is the highest spatial frequency at which that is at least half, as far as the
pixels of the pictures carry one. The code normalizes contrast, so this is a limit of resolution,
not of contrast.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.clinic.psychometric import resampled
from eye_plant.camera.blur import Blur
from eye_plant.camera.config import CameraConfig
from eye_plant.vergence import degrees_per_px
from lockstep.scales import Scale
from sparse_coder import SparseCoder
from sparse_coder.matching_pursuit import residuals_of_eyes
from sparse_coder.picture_of_code import coded_patches

Array = NDArray[np.float64]
Pictures = tuple[NDArray[np.uint8], NDArray[np.uint8]]

# Cycles per pixel, up to Nyquist's limit; cycles per degree follow from the camera.
CYCLES_PER_PX = np.geomspace(0.02, 0.5, 15)
_ORIENTATIONS_DEG = (0.0, 45.0, 90.0, 135.0)
# At Nyquist's limit a phase of 0 or 180 deg would show nothing.
_PHASES_DEG = (45.0, 135.0, 225.0, 315.0)
_LEAST_EXPLAINED = 0.5
# What one who just sees 30 cycles/deg resolves: a minute of arc.
_ONE_MINUTE = 30.0
# Cycles per pixel of what both eyes see at once.
_RIVAL = 0.125


@dataclass(frozen=True)
class Resolution:
    """What the code explains of the gratings that one eye sees.

    cycles_per_deg: (n,), rising; shares: (n, k) explained, of k orientations and phases.
    """

    cycles_per_deg: Array
    shares: Array

    @property
    def explained(self) -> Array:
        """Means (n,) over orientations and phases."""
        return np.asarray(self.shares.mean(axis=1))

    @property
    def acuity(self) -> float | None:
        """Highest frequency in cycles/deg at which half is explained, None for none.

        Linear over the logarithm of the frequency; at most the highest frequency shown.
        """
        return crossing(np.log(self.cycles_per_deg), self.explained, _LEAST_EXPLAINED)

    @property
    def log_mar(self) -> float | None:
        """The acuity as log10 of the angle in minutes that half a cycle takes; 0 is 20/20."""
        return None if self.acuity is None else math.log10(_ONE_MINUTE / self.acuity)

    @cached_property
    def interval(self) -> tuple[float, float] | None:
        """95 % interval of the acuity over gratings; 0 cycles/deg stand for none."""

        def acuity(drawn: NDArray[np.intp]) -> float:
            return Resolution(self.cycles_per_deg, self.shares[:, drawn]).acuity or 0.0

        return resampled(self.shares.shape[1], acuity)


def crossing(log_x: Array, share: Array, least: float) -> float | None:
    """Return the largest x at which a share (n,) over log(x) (n,), rising, reaches a level.

    Linear between two x; None where it reaches it nowhere.
    """
    reached = np.flatnonzero(share >= least)
    if not len(reached):
        return None
    last = reached[-1]
    if last == len(share) - 1:
        return float(np.exp(log_x[-1]))
    part = (share[last] - least) / (share[last] - share[last + 1])
    return float(np.exp(log_x[last] + part * (log_x[last + 1] - log_x[last])))


def resolution(
    coder: SparseCoder,
    camera: CameraConfig,
    i_eye: int,
    cycles_per_px: Array = CYCLES_PER_PX,
) -> Resolution:
    """Return what the frozen code explains of gratings before one eye, 0 left or 1 right.

    camera: of the eyes; their blur, magnification and cover count. cycles_per_px: (n,), rising, of
    the pictures that the finest scale is cut from.
    """
    zoom = finest(coder).zoom
    size_px = (camera.width_px, camera.height_px)
    along_rows, along_columns = camera.blurs_px[i_eye]
    blur = Blur(size_px, size_px, (zoom * along_rows, zoom * along_columns))
    is_blurred, is_covered = any(camera.blurs_px[i_eye]), camera.occlusions[i_eye]
    black = np.zeros(size_px[::-1], np.uint8)
    shares = np.zeros((len(cycles_per_px), len(_ORIENTATIONS_DEG), len(_PHASES_DEG)))
    for place in np.ndindex(shares.shape):
        i, i_orientation, i_phase = place
        picture = grating(
            size_px, float(cycles_per_px[i]), _ORIENTATIONS_DEG[i_orientation], _PHASES_DEG[i_phase]
        )
        seen = black if is_covered else blur(picture) if is_blurred else picture
        shown, coded = ((p, black) if i_eye == 0 else (black, p) for p in (picture, seen))
        shares[place] = explained_share(coder, shown, coded)
    px_deg = degrees_per_px(zoom * camera.focal_length_px * camera.magnifications[i_eye])
    return Resolution(cycles_per_px / px_deg, shares.reshape(len(shares), -1))


def grating(
    size_px: tuple[int, int], cycles_per_px: float, orientation_deg: float, phase_deg: float
) -> NDArray[np.uint8]:
    """Return a sinusoidal grating (height, width) of full contrast.

    size_px: width, height; orientation_deg: of the stripes, 0 horizontal, 90 vertical; phase_deg:
    at the top left.
    """
    width_px, height_px = size_px
    row, column = np.mgrid[:height_px, :width_px]
    angle = np.radians(orientation_deg)
    across_px = column * np.sin(angle) + row * np.cos(angle)
    wave = np.sin(2.0 * np.pi * cycles_per_px * across_px + np.radians(phase_deg))
    # About a whole grey level: what blur leaves of a mean between two of them rounds to a pattern.
    return np.rint(128.0 + 127.0 * wave).astype(np.uint8)


def finest(coder: SparseCoder) -> Scale:
    """Return the scale with the smallest pixels, the first of several."""
    return min(coder.config.scales.all, key=lambda scale: scale.px_per_pixel)


def explained_share(coder: SparseCoder, shown: Pictures, seen: Pictures) -> float:
    """Return the share of the energy of what is shown that the finest code of the seen explains.

    1 - sum |p - c|^2 / sum |p|^2, at least 0; p: patches of the shown pictures, c: what the code of
    the seen ones makes of them. Where the eyes see what is shown, it is what the reconstruction
    error leaves. shown, seen: left and right picture, of which shown is not uniform; all scales see
    these, each in pictures of its own.
    """
    scales, scale = coder.config.scales, finest(coder)
    i = scales.all.index(scale)
    patches = coder.patches(*shown, _apart(shown, scales.apart))[0][i]
    coded = coded_patches(
        coder.encode(*seen, _apart(seen, scales.apart)).selections[i], coder.atoms()[i]
    )
    left = np.square(patches - coded, dtype=np.float64).sum()
    return max(0.0, float(1.0 - left / np.square(patches, dtype=np.float64).sum()))


def rival_shares(coder: SparseCoder, camera: CameraConfig) -> Array:
    """Return the share (2,) of each eye's image that the finest code has of two rival ones.

    Each eye sees an oblique grating of a fine and clear frequency, across the other one's, as
    through Bagolini's glasses: where neither is suppressed, the code has of both alike. Both
    orientations go to either eye; the share is 1 - residual / energy.
    """
    scales, i = coder.config.scales, coder.config.scales.all.index(finest(coder))
    size_px = (camera.width_px, camera.height_px)
    left_over, whole = np.zeros(2), np.zeros(2)
    for turns_deg in ((45.0, 135.0), (135.0, 45.0)):
        for phase_deg in _PHASES_DEG:
            left, right = (grating(size_px, _RIVAL, turn, phase_deg) for turn in turns_deg)
            encoding = coder.encode(left, right, _apart((left, right), scales.apart))
            halves = encoding.patches[i].reshape(len(encoding.patches[i]), 2, -1)
            whole += np.square(halves, dtype=np.float64).sum(axis=(0, 2))
            left_over += residuals_of_eyes(
                encoding.patches[i], coder.atoms()[i], encoding.selections[i]
            ).sum(axis=0)
    return np.asarray(1.0 - left_over / whole)


def _apart(pictures: Pictures, scales: Sequence[Scale]) -> list[NDArray[np.uint8]]:
    """Return both pictures for each scale, (2, window_px, window_px), about their centre."""
    both = np.stack(pictures)
    found = []
    for scale in scales:
        top, left = ((side - scale.window_px) // 2 for side in both.shape[1:])
        rows, columns = (slice(n, n + scale.window_px) for n in (top, left))
        found.append(np.ascontiguousarray(both[:, rows, columns]))
    return found
