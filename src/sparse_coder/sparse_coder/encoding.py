"""The sparse code of a pair of pictures.

Dimensions: n_scales is 2, coarse before fine; n_patches, n_pixels, n_bases.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from sparse_coder.matching_pursuit import Selections


@dataclass(frozen=True)
class Encoding:
    """The sparse code of one pair of pictures.

    features: (n_scales, n_bases) mean squared coefficient of each atom;
    reconstruction_error: (n_scales,) unexplained share of the patches' energy, in [0, 1];
    patches: per scale (n_patches, n_pixels); selections: per scale.
    """

    features: NDArray[np.float32]
    reconstruction_error: NDArray[np.float64]
    patches: tuple[NDArray[np.float32], ...]
    selections: tuple[Selections, ...]
