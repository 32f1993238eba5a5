"""Matching pursuit (Mallat & Zhang 1993) of many patches with one dictionary of unit atoms.

Dimensions: n_patches, n_pixels, n_bases, n_selections.
"""

from dataclasses import dataclass

import numpy as np
from numba import float32, float64, int32, njit, void
from numpy.typing import NDArray

_MAGNITUDE_BITS = np.int32(0x7FFFFFFF)


@dataclass(frozen=True)
class Selections:
    """What matching pursuit chose, in the order of choosing.

    atoms: (n_patches, n_selections) index of each selected atom; one may come again.
    coefficients: (n_patches, n_selections) the correlation that each selection took away.
    """

    atoms: NDArray[np.int32]
    coefficients: NDArray[np.float32]


def matching_pursuit(
    patches: NDArray[np.float32],
    atoms: NDArray[np.float32],
    gram: NDArray[np.float32],
    n_selections: int,
) -> Selections:
    """Select n_selections times the atom with the largest |correlation| to the residual.

    r_0 = p; k = argmax |phi_k . r|, the first of equals; kappa = phi_k . r; r <- r - kappa phi_k.
    The residual itself is never formed: its correlations follow from the Gram matrix,
    phi_i . r <- phi_i . r - kappa phi_i . phi_k.

    patches: (n_patches, n_pixels).
    atoms: (n_bases, n_pixels), unit rows.
    gram: (n_bases, n_bases), all products of two atoms.
    n_selections: of each patch.
    """
    correlations = np.matmul(patches, atoms.T)
    selected = np.empty((patches.shape[0], n_selections), np.int32)
    coefficients = np.empty((patches.shape[0], n_selections), np.float32)
    _pursue(correlations, gram, selected, coefficients)
    return Selections(selected, coefficients)


def mean_squared_coefficients(selections: Selections, n_bases: int) -> NDArray[np.float32]:
    """Return, for each atom, the mean over patches of its squared coefficient, (n_bases,).

    The coefficient of an atom in a patch is the sum over its selections there.
    """
    features = np.zeros(n_bases, np.float64)
    _add_squared_coefficients(selections.atoms, selections.coefficients, features)
    return (features / selections.atoms.shape[0]).astype(np.float32)


def residual_energies(patches: NDArray[np.float32], selections: Selections) -> NDArray[np.float32]:
    """Return the sum of squared residuals of each patch, (n_patches,).

    Each selection of a unit atom takes kappa^2 from it (Mallat & Zhang 1993).
    """
    coded: NDArray[np.float32] = (selections.coefficients**2).sum(axis=1)
    return np.maximum((patches**2).sum(axis=1) - coded, np.float32(0.0))


def residuals_of_eyes(
    patches: NDArray[np.float32], atoms: NDArray[np.float32], selections: Selections
) -> NDArray[np.float64]:
    """Return the sum of squared residuals of each eye's half of each patch, (n_patches, 2).

    An atom is a unit over both eyes, so that the halves' residuals have to be formed.
    """
    residuals = np.empty((len(patches), 2))
    _add_up_residuals(patches, atoms, selections.atoms, selections.coefficients, residuals)
    return residuals


@njit(
    void(float32[:, ::1], float32[:, ::1], int32[:, ::1], float32[:, ::1], float64[:, ::1]),
    cache=True,
    nogil=True,
)
def _add_up_residuals(
    patches: NDArray[np.float32],
    atoms: NDArray[np.float32],
    selected: NDArray[np.int32],
    coefficients: NDArray[np.float32],
    residuals: NDArray[np.float64],
) -> None:
    n_patches, n_selections = selected.shape
    half = patches.shape[1] // 2
    rest = np.empty(patches.shape[1], np.float32)
    for i_patch in range(n_patches):
        rest[:] = patches[i_patch]
        for i in range(n_selections):
            coefficient, atom = coefficients[i_patch, i], atoms[selected[i_patch, i]]
            for i_pixel in range(rest.size):
                rest[i_pixel] -= coefficient * atom[i_pixel]
        for i_eye in range(2):
            total = 0.0
            for i_pixel in range(i_eye * half, (i_eye + 1) * half):
                total += np.float64(rest[i_pixel]) ** 2
            residuals[i_patch, i_eye] = total


@njit(
    void(float32[:, ::1], float32[:, ::1], int32[:, ::1], float32[:, ::1]), cache=True, nogil=True
)
def _pursue(
    correlations: NDArray[np.float32],
    gram: NDArray[np.float32],
    atoms: NDArray[np.int32],
    coefficients: NDArray[np.float32],
) -> None:
    """Fill atoms and coefficients; correlations end as those of the last residual.

    Without their sign bit, floats sort as integers do. Integer maxima may be taken in any order,
    so that the compiler uses the vector unit where a float maximum would go one by one.
    """
    n_patches, n_bases = correlations.shape
    bits = correlations.view(np.int32)
    for i_patch in range(n_patches):
        correlation = correlations[i_patch]
        magnitude = bits[i_patch]
        largest = np.int32(0)
        for i in range(n_bases):
            largest = max(largest, np.int32(magnitude[i] & _MAGNITUDE_BITS))
        for i_selection in range(atoms.shape[1]):
            n_from_end = np.int32(0)
            for i in range(n_bases):
                is_largest = np.int32(magnitude[i] & _MAGNITUDE_BITS) == largest
                n_from_end = max(n_from_end, np.int32(n_bases - i) if is_largest else np.int32(0))
            i_atom = n_bases - n_from_end
            coefficient = correlation[i_atom]
            atoms[i_patch, i_selection] = i_atom
            coefficients[i_patch, i_selection] = coefficient
            products = gram[i_atom]
            largest = np.int32(0)
            for i in range(n_bases):
                correlation[i] -= coefficient * products[i]
                largest = max(largest, np.int32(magnitude[i] & _MAGNITUDE_BITS))


@njit(void(int32[:, ::1], float32[:, ::1], float64[::1]), cache=True, nogil=True)
def _add_squared_coefficients(
    atoms: NDArray[np.int32], coefficients: NDArray[np.float32], features: NDArray[np.float64]
) -> None:
    n_patches, n_selections = atoms.shape
    total = np.zeros(features.size)
    for i_patch in range(n_patches):
        for i in range(n_selections):
            total[atoms[i_patch, i]] += coefficients[i_patch, i]
        for i in range(n_selections):
            i_atom = atoms[i_patch, i]
            features[i_atom] += total[i_atom] ** 2
            total[i_atom] = 0.0  # so that an atom selected twice counts once


# "reassoc" lets the sum use the vector unit; the order is fixed once compiled, so that the same
# machine gives the same bits.
@njit(float64(float32[:, ::1]), cache=True, nogil=True, fastmath={"reassoc"})
def energy(values: NDArray[np.float32]) -> float:
    """Return the sum of squares of a matrix."""
    total = 0.0
    for i_row in range(values.shape[0]):
        for i in range(values.shape[1]):
            total += np.float64(values[i_row, i]) ** 2
    return total
