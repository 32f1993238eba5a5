"""The picture that a sparse code holds: the windows, put together again from their patches' codes.

Dimensions: n_eyes is 2, left before right; n_patches, n_pixels, n_bases.
"""

import numpy as np
from numpy.typing import NDArray

from lockstep.scales import PATCH_SIZE_PX, STRIDE_PX
from sparse_coder.matching_pursuit import Selections
from sparse_coder.patches import Image
from sparse_coder.percept import Encoding
from sparse_coder.windows import windows_of


def seen_windows(left: Image, right: Image) -> tuple[NDArray[np.float32], ...]:
    """Return what is coded at the default scales, (n_eyes, side_px, side_px), in grey levels."""
    return tuple(np.stack(pair) for pair in windows_of(left, right))


def reconstructed_windows(
    encoding: Encoding, atoms: NDArray[np.float32], left: Image, right: Image
) -> tuple[NDArray[np.float32], ...]:
    """Return the windows as their code has them, (n_eyes, side_px, side_px) per scale.

    Each patch is the sum of its atoms times their coefficients. The code knows neither mean nor
    contrast of a patch, so both are taken from the pictures. Where patches overlap, their mean is
    shown. atoms: (n_scales, n_bases, n_pixels), those of the encoding.
    """
    return tuple(
        _reconstructed(coded_patches(selections, atoms_of_scale), seen)
        for selections, atoms_of_scale, seen in zip(
            encoding.selections, atoms, seen_windows(left, right), strict=True
        )
    )


def coded_patches(selections: Selections, atoms: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return sum_k kappa_jk phi_k of each patch j, (n_patches, n_pixels)."""
    chosen = atoms[selections.atoms]
    coded: NDArray[np.float32] = np.einsum("jk,jkp->jp", selections.coefficients, chosen)
    return coded


def _reconstructed(patches: NDArray[np.float32], seen: NDArray[np.float32]) -> NDArray[np.float32]:
    """Lay patches (n_patches, n_pixels) with the seen ones' means and norms over one another."""
    total, count = np.zeros_like(seen), np.zeros_like(seen)
    n_columns = (seen.shape[2] - PATCH_SIZE_PX) // STRIDE_PX + 1
    size = PATCH_SIZE_PX
    for i_patch, patch in enumerate(patches.reshape(-1, 2, size, size)):
        i_row, i_column = divmod(i_patch, n_columns)
        top, first = STRIDE_PX * i_row, STRIDE_PX * i_column
        covered = (slice(None), slice(top, top + size), slice(first, first + size))
        mean = seen[covered].mean(axis=(1, 2), keepdims=True)
        norm = np.linalg.norm(seen[covered] - mean, axis=(1, 2), keepdims=True)
        total[covered] += mean + norm * patch
        count[covered] += 1.0
    return total / count
