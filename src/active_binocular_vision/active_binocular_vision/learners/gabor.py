"""Gabor functions fitted to basis functions by least squares.

One function describes the halves of both eyes, or one half alone. With x' along the wave vector and
y' along the stripes, from the centre (x0, y0), eye e has

    g_e(x, y) = A_e exp(-x'^2 / 2 s_x^2 - y'^2 / 2 s_y^2) cos(2 pi x' / wavelength + phase_e):

orientation, wavelength, centre and envelope are common, amplitude and phase each eye's own, so a
disparity is a difference of phases (Klimmasch et al. 2021, eLife 10:e56212; ten parameters).

Dimensions: n fits, n_eyes halves described together, n_pixels of one half (8 x 8), 6 parameters
that enter non-linearly.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from lockstep import InputError
from lockstep.scales import PATCH_SIZE_PX

Array = NDArray[np.float64]

N_PIXELS_OF_EYE = PATCH_SIZE_PX**2
# A fit counts whose squared residuals are at most this share of the squared entries.
GOOD_RESIDUAL = 0.2

_HALF_PX = PATCH_SIZE_PX / 2.0
# theta, log wavelength, x0, y0, log s_x, log s_y. The angle is periodic; the others have bounds:
# shorter waves than two pixels cannot be told apart, a centre lies in the patch, and beyond twice
# the patch waves and envelopes are all alike.
_LOWEST = np.array([-np.inf, np.log(2.0), -_HALF_PX, -_HALF_PX, np.log(0.5), np.log(0.5)])
_HIGHEST = np.array([np.inf, np.log(16.0), _HALF_PX, _HALF_PX, np.log(8.0), np.log(8.0)])
_N_STARTS = 4
_N_STEPS = 60
_CONVERGED = 1e-9
_LARGEST_DAMPING = 1e8
# Fits made at once: their Jacobians fit into the processor's cache.
_N_AT_ONCE = 256


@dataclass(frozen=True)
class Gabors:
    """Fitted Gabor functions, lengths in pixels of the scale from the patch's centre, y upward.

    orientation_deg (n,): of the stripes, in [0, 180): 0 horizontal, 90 vertical, counter-clockwise.
    wave_angle_deg (n,): direction in which the phase grows, in [-90, 90), 0 to the right.
    wavelength_px (n,). phase_rad (n, n_eyes). patches (n, n_eyes, 64): the functions themselves.
    residual (n,): share of the squared entries that the fit leaves; 1 where there are none.
    """

    orientation_deg: Array
    wave_angle_deg: Array
    wavelength_px: Array
    phase_rad: Array
    patches: Array
    residual: Array

    @property
    def is_good(self) -> NDArray[np.bool_]:
        """Which fits count (n,)."""
        return self.residual <= GOOD_RESIDUAL


def fit_gabors(patches: Array) -> Gabors:
    """Fit one Gabor function to each of patches (n, n_eyes, 64), pixels row by row from the top.

    Levenberg-Marquardt from several starts; the amplitudes, in which the function is linear, follow
    from the other parameters (variable projection, Golub & Pereyra 1973, with Kaufman's Jacobian).
    Hundreds of fits side by side: one after the other, scipy.optimize.least_squares finds the same
    in forty times as long.
    """
    if patches.ndim != 3 or patches.shape[2] != N_PIXELS_OF_EYE:
        raise InputError(
            f"expected patches (n, n_eyes, {N_PIXELS_OF_EYE}), got shape {patches.shape}"
        )
    patches = patches.astype(np.float64)
    energy = (patches**2).sum(axis=(1, 2))
    targets = patches / np.sqrt(np.where(energy > 0.0, energy, 1.0))[:, None, None]
    best = np.empty((len(targets), 6))
    for first in range(0, len(targets), _N_AT_ONCE):
        some = slice(first, first + _N_AT_ONCE)
        best[some] = _best_parameters(targets[some])
    waves, _ = _waves(best)
    coefficients = _coefficients(waves, targets)
    fitted = _combined(waves, coefficients)
    left = ((targets - fitted) ** 2).sum(axis=(1, 2))
    norm = np.sqrt(energy)[:, None, None]
    return _as_gabors(
        best,
        coefficients * norm,
        fitted * norm,
        np.where(energy > 0.0, np.minimum(left, 1.0), 1.0),
    )


def _as_gabors(parameters: Array, coefficients: Array, patches: Array, residual: Array) -> Gabors:
    # A wave that runs the other way is the same with its sine, so its phase, negated.
    theta = parameters[:, 0]
    turned = np.mod(theta + np.pi / 2.0, np.pi) - np.pi / 2.0
    is_flipped = np.cos(turned - theta) < 0.0
    sines = np.where(is_flipped[:, None], -coefficients[..., 1], coefficients[..., 1])
    wave_angle_deg = np.degrees(turned)
    return Gabors(
        orientation_deg=np.mod(wave_angle_deg + 90.0, 180.0),
        wave_angle_deg=wave_angle_deg,
        wavelength_px=np.exp(parameters[:, 1]),
        phase_rad=np.arctan2(-sines, coefficients[..., 0]),
        patches=patches,
        residual=residual,
    )


# The fit


def _best_parameters(targets: Array) -> Array:
    """Return the parameters (n, 6) of the best fit among several starts."""
    starts = _starts(targets)
    n_starts = starts.shape[1]
    repeated = np.repeat(targets, n_starts, axis=0)
    fitted, cost = _levenberg_marquardt(starts.reshape(-1, 6), repeated)
    fitted, cost = fitted.reshape(-1, n_starts, 6), cost.reshape(-1, n_starts)
    return fitted[np.arange(len(targets)), cost.argmin(axis=1)]


def _starts(targets: Array) -> Array:
    """Return the most promising parameters of a coarse grid, (n, _N_STARTS, 6).

    Each is the best of its orientation: of 8 those that explain most.
    """
    angles = np.arange(8) * np.pi / 8.0
    lengths = [(w, s) for w in (3.0, 4.5, 7.0, 12.0) for s in (1.3, 2.2, 3.5)]
    centres = [(x, y) for x in (-2.0, 0.0, 2.0) for y in (-2.0, 0.0, 2.0)]
    grid = np.array(
        [
            [angle, np.log(w), x, y, np.log(s), np.log(s)]
            for angle in angles
            for w, s in lengths
            for x, y in centres
        ]
    )
    waves, _ = _waves(grid)
    orthonormal = np.linalg.qr(waves)[0]
    projected = np.einsum("gpk,nep->ngek", orthonormal, targets, optimize=True)
    explained = (projected**2).sum(axis=(2, 3)).reshape(len(targets), len(angles), -1)
    n_per_angle = len(grid) // len(angles)
    places = explained.argmax(axis=2) + n_per_angle * np.arange(len(angles))
    promising = np.argsort(-explained.max(axis=2), axis=1)[:, :_N_STARTS]
    return grid[np.take_along_axis(places, promising, axis=1)]


def _levenberg_marquardt(parameters: Array, targets: Array) -> tuple[Array, Array]:
    """Return fitted parameters (m, 6) and the squared residuals left (m,), all fits side by side.

    Those that have converged drop out of the work.
    """
    parameters = parameters.copy()
    residuals, jacobian = _linearised(parameters, targets)
    cost = (residuals**2).sum(axis=1)
    damping = np.full(len(parameters), 1e-2)
    active = np.arange(len(parameters))
    for _ in range(_N_STEPS):
        if not len(active):
            break
        trial = _stepped(parameters[active], residuals, jacobian, damping[active])
        new_residuals, new_jacobian = _linearised(trial, targets[active])
        new_cost = (new_residuals**2).sum(axis=1)
        gained = cost[active] - new_cost
        better = gained > 0.0
        parameters[active[better]] = trial[better]
        cost[active[better]] = new_cost[better]
        residuals = np.where(better[:, None], new_residuals, residuals)
        jacobian = np.where(better[:, None, None], new_jacobian, jacobian)
        damping[active] *= np.where(better, 0.3, 5.0)
        done = (better & (gained < _CONVERGED)) | (damping[active] > _LARGEST_DAMPING)
        active, residuals, jacobian = active[~done], residuals[~done], jacobian[~done]
    return parameters, cost


def _stepped(parameters: Array, residuals: Array, jacobian: Array, damping: Array) -> Array:
    """Return the parameters after one damped Gauss-Newton step, within their bounds."""
    normal = np.einsum("mpi,mpj->mij", jacobian, jacobian, optimize=True)
    gradient = np.einsum("mpi,mp->mi", jacobian, residuals, optimize=True)
    diagonal = np.einsum("mii->mi", normal)
    scaled = damping[:, None] * (diagonal + 1e-6)
    normal = normal + scaled[:, :, None] * np.eye(6)
    step = np.linalg.solve(normal, gradient[:, :, None])[:, :, 0]
    return np.clip(parameters - step, _LOWEST, _HIGHEST)


def _linearised(parameters: Array, targets: Array) -> tuple[Array, Array]:
    """Return residuals (m, n_eyes x 64) of the best amplitudes, and their Jacobian (.., 6).

    Kaufman's: the derivative of the waves, times the amplitudes, less its part in the waves' span.
    """
    waves, slopes = _waves(parameters)
    coefficients = _coefficients(waves, targets)
    residuals = _combined(waves, coefficients) - targets
    change = np.einsum("mpkj,mek->mepj", slopes, coefficients, optimize=True)
    inside = np.einsum("mpk,mepj->mekj", waves, change, optimize=True)
    solved = np.linalg.solve(_gram(waves)[:, None], inside)
    change -= np.einsum("mpk,mekj->mepj", waves, solved, optimize=True)
    m = len(parameters)
    return residuals.reshape(m, -1), change.reshape(m, -1, 6)


def _coefficients(waves: Array, targets: Array) -> Array:
    """Return the best amplitudes (m, n_eyes, 2) of cosine and sine."""
    inside = np.einsum("mpk,mep->mke", waves, targets, optimize=True)
    return np.linalg.solve(_gram(waves), inside).transpose(0, 2, 1)


def _gram(waves: Array) -> Array:
    """Return the waves' inner products (m, 2, 2); a wave that is 0 everywhere gets amplitude 0."""
    gram: Array = np.einsum("mpk,mpl->mkl", waves, waves, optimize=True)
    return gram + 1e-9 * np.eye(2)


def _combined(waves: Array, coefficients: Array) -> Array:
    return np.einsum("mpk,mek->mep", waves, coefficients, optimize=True)


def _waves(parameters: Array) -> tuple[Array, Array]:
    """Return cosine and sine under the envelope (m, 64, 2) and their derivatives (m, 64, 2, 6)."""
    theta, log_wavelength, x0, y0, log_width, log_length = (
        column[:, None] for column in parameters.T
    )
    along_row = np.arange(PATCH_SIZE_PX) - (PATCH_SIZE_PX - 1) / 2.0
    x, y = (grid.ravel() for grid in np.meshgrid(along_row, -along_row))
    cosine, sine = np.cos(theta), np.sin(theta)
    dx, dy = x - x0, y - y0
    across = dx * cosine + dy * sine
    along = dy * cosine - dx * sine
    k = 2.0 * np.pi / np.exp(log_wavelength)
    narrow, long = np.exp(-2.0 * log_width), np.exp(-2.0 * log_length)
    envelope = np.exp(-0.5 * (across**2 * narrow + along**2 * long))
    carrier = np.exp(1j * k * across)
    # The logarithm of the complex wave is simple to differentiate.
    wave = envelope * carrier
    per_across = 1j * k - across * narrow
    per_along = -along * long
    slopes = (
        per_across * along - per_along * across,
        -1j * k * across,
        -per_across * cosine + per_along * sine,
        -per_across * sine - per_along * cosine,
        across**2 * narrow,
        along**2 * long,
    )
    derivative = np.stack([wave * slope for slope in slopes], axis=-1)
    return (
        np.stack([wave.real, wave.imag], axis=-1),
        np.stack([derivative.real, derivative.imag], axis=-2),
    )
