"""Suppression: at each place the eye whose image the code has more of gains at the other's cost.

Both halves of a patch have a gain, g_L = sqrt(1 + d) and g_R = sqrt(1 - d); its energy stays 2.

    tau dd/dt = w_L c_L - w_R c_R - k max(0, rho) d,    |d| <= 0.98

c: the code's part along an eye's half, as a share of that half; w: that eye's share of the
contrast energy of both images there; tau: iterations; rho: the correlation of both halves; k: 0.2.
As d rises, E falls: by the envelope theorem dE/dd = (c_R - c_L) / 2 with the code at its best
(ours). So each eye inhibits the other one as far as the code is its own. Where both images agree,
atoms code them together, have too much of a half whose gain is low, and give it back; where they
differ, the code chooses, and the choice grows. Contrast weighs as in models of binocular gain
control (Ding & Sperling 2006), and decides between eyes of unequal focus (Eckmann et al. 2020),
since a blurred half alone is coded better. Only unlike images suppress one another (Sengpiel &
Blakemore 1994): those that are alike release the weaker eye, as atoms that were learned while it
was suppressed would not (ours).
"""

import numpy as np
from numpy.typing import NDArray

# So that an eye that is suppressed can come back.
MOST = 0.98
_RELEASE = 0.2

Array = NDArray[np.float64]


def gains(dominance: Array) -> Array:
    """Return g of the left and the right eye, (n_patches, 2), from d (n_patches,) in [-1, 1]."""
    return np.sqrt(np.stack([1.0 + dominance, 1.0 - dominance], axis=-1))


def with_gains(patches: NDArray[np.float32], dominance: Array) -> NDArray[np.float32]:
    """Return patches (n_patches, n_pixels) with the gain of each eye on its half."""
    of_halves = gains(dominance).astype(np.float32)
    halves = patches.reshape(len(patches), 2, -1) * of_halves[:, :, None]
    return np.ascontiguousarray(halves.reshape(patches.shape))


def learned_dominance(
    dominance: Array,
    patches: NDArray[np.float32],
    coded: NDArray[np.float32],
    energies: Array,
    n_iterations: int,
) -> Array:
    """Return d (n_patches,) after one iteration of n_iterations, tau.

    patches: (n_patches, n_pixels) with gains; coded: what their code has of them; energies:
    (n_patches, 2) of each eye's half in the image.
    """
    halves, codes = (p.reshape(len(p), 2, -1).astype(np.float64) for p in (patches, coded))
    along, whole = (halves * codes).sum(axis=2), (halves**2).sum(axis=2)
    total = energies.sum(axis=1, keepdims=True)
    shares = _ratio(along, whole) * _ratio(energies, total)
    alike = _ratio((halves[:, 0] * halves[:, 1]).sum(axis=1), np.sqrt(whole.prod(axis=1)))
    released = _RELEASE * np.maximum(0.0, alike) * dominance
    moved = dominance + (shares[:, 0] - shares[:, 1] - released) / n_iterations
    return np.asarray(np.clip(moved, -MOST, MOST))


def _ratio(part: Array, whole: Array) -> Array:
    """Return part / whole, 0 where the whole is 0."""
    return np.asarray(np.divide(part, whole, out=np.zeros_like(part), where=whole > 0.0))
