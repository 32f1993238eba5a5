"""Our encoding of a pair of pictures against plain NumPy and against a published sparse coder."""

import importlib.util
import time
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from sparse_coder.coder import SparseCoder

Floats = NDArray[np.float32]


def plain_matching_pursuit(
    patches: Floats, atoms: Floats, n_selections: int
) -> tuple[NDArray[np.intp], Floats]:
    """Return matching pursuit's (atoms, coefficients), both (n_patches, n_selections).

    The rule of sparse_coder.matching_pursuit as array operations, one line each: the correlations
    of all residuals with all atoms are kept up to date through the Gram matrix.

    patches: (n_patches, n_pixels); atoms: (n_bases, n_pixels), unit rows.
    """
    correlations = patches @ atoms.T
    gram = atoms @ atoms.T
    rows = np.arange(len(patches))
    selected = np.empty((len(patches), n_selections), np.intp)
    coefficients = np.empty((len(patches), n_selections), np.float32)
    for i in range(n_selections):
        selected[:, i] = np.abs(correlations).argmax(axis=1)
        coefficients[:, i] = correlations[rows, selected[:, i]]
        correlations -= coefficients[:, i, None] * gram[selected[:, i]]
    return selected, coefficients


def encoding_times_ms(
    coder: SparseCoder, pictures: list[np.ndarray], n_rounds: int
) -> dict[str, float]:
    """Return the median time of one pair, both scales, by each coder; interleaved.

    pictures: pairs (2, height, width). Ours is timed from the pictures to the features; the others
    get the patches ready-made and stop at the coefficients. "sklearn": orthogonal matching pursuit
    with as many non-zero entries, if scikit-learn is installed.
    """
    n_selections = coder.config.n_selections
    encodings = [coder.encode(*pair) for pair in pictures]
    atoms = coder.atoms()

    def plain(i: int) -> None:
        for scale_patches, scale_atoms in zip(encodings[i].patches, atoms, strict=True):
            plain_matching_pursuit(scale_patches, scale_atoms, n_selections)

    coders: dict[str, Callable[[int], object]] = {
        "ours": lambda i: coder.encode(*pictures[i]),
        "numpy": plain,
    }
    if importlib.util.find_spec("sklearn") is not None:
        sparse_encode = importlib.import_module("sklearn.decomposition").sparse_encode

        def published(i: int) -> None:
            for scale_patches, scale_atoms in zip(encodings[i].patches, atoms, strict=True):
                sparse_encode(
                    scale_patches, scale_atoms, algorithm="omp", n_nonzero_coefs=n_selections
                )

        coders["sklearn"] = published
    durations_ms: dict[str, list[float]] = {name: [] for name in coders}
    for i_round in range(n_rounds):
        for name, encode in coders.items():
            start_s = time.perf_counter()
            encode(i_round % len(pictures))
            durations_ms[name].append(1e3 * (time.perf_counter() - start_s))
    return {name: float(np.median(values)) for name, values in durations_ms.items()}
