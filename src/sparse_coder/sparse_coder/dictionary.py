"""One scale's dictionary: unit atoms, and what matching pursuit needs to know of them.

Dimensions: n_patches, n_pixels, n_bases, n_selections.
"""

import numpy as np
from numba import float32, float64, int32, njit, void
from numpy.typing import NDArray

from sparse_coder.matching_pursuit import Selections

# Of the slow mean of E: time constant of the fast one, and the gap at which all is plastic.
_FAST_SHARE, _FULL_GAP = 0.25, 0.1


class Dictionary:
    """Unit atoms and their Gram matrix, always of the same atoms.

    atoms: (n_bases, n_pixels); gram: (n_bases, n_bases).
    """

    def __init__(self, atoms: NDArray[np.float32]) -> None:
        """Start from float32 atoms of norm 1, (n_bases, n_pixels)."""
        n_bases, _ = atoms.shape
        self.gram = np.empty((n_bases, n_bases), np.float32)
        self.replace(atoms)

    def replace(self, atoms: NDArray[np.float32]) -> None:
        """Hold other atoms of the same shape; the array is taken over, not copied.

        The Gram matrix is made from the atoms alone, never amended, so that a resumed run has the
        same bits. A matrix times its own transpose costs BLAS half a product.
        """
        self.atoms = atoms
        np.matmul(atoms, atoms.T, out=self.gram)


def initial_atoms(
    generator: np.random.Generator, n_bases: int, n_pixels: int
) -> NDArray[np.float32]:
    """Return atoms drawn uniformly from [-0.5, 0.5] and normalised, (n_bases, n_pixels)."""
    atoms = generator.uniform(-0.5, 0.5, (n_bases, n_pixels))
    return (atoms / np.linalg.norm(atoms, axis=1, keepdims=True)).astype(np.float32)


def dictionary_rate(initial_rate: float, final_share: float, fraction_done: float) -> float:
    """Return the learning rate, linear from initial_rate to final_share of it (D17; K17: 1).

    ours: the actor's own rate falls to 0, so it cannot follow features that go on changing.
    fraction_done: of the way to rest, in [0, 1].
    """
    return initial_rate * (1.0 - (1.0 - final_share) * fraction_done)


def learned_means(
    means: NDArray[np.float64], error: float, n_iterations: int
) -> NDArray[np.float64]:
    """Return the fast and the slow running mean of E, (2,), after an iteration with E = error.

    n_iterations: time constant of the slow one; that of the fast one is a quarter of it.
    """
    rates = np.array([1.0 / _FAST_SHARE, 1.0]) / n_iterations
    return np.asarray(means + rates * (error - means))


def plasticity(means: NDArray[np.float64]) -> float:
    """Return eta / eta_0 = min(1, (|S - F| / 0.1 S)^2) of the fast mean of E, F, and the slow S.

    ours: while learning lowers E, F is ahead of S. Once there is no more to learn they meet, and
    dictionaries rest; a change of what is seen parts them again. The square keeps small what F's
    scatter does.
    """
    fast, slow = means.tolist()
    return min(1.0, ((slow - fast) / (_FULL_GAP * slow)) ** 2) if slow > 0.0 else 0.0


def learned_atoms(
    atoms: NDArray[np.float32],
    patches: NDArray[np.float32],
    selections: Selections,
    learning_rate: float,
) -> NDArray[np.float32]:
    """Return the atoms after one step down the gradient of the squared residuals.

    phi_k <- phi_k + eta / n_patches * sum_j kappa_jk r_j, then divided by its norm, where
    r_j = p_j - sum_k kappa_jk phi_k (Olshausen & Field 1996, as in K17). An atom that would vanish
    stays as it was; one that was not selected has no gradient and stays too.

    atoms: (n_bases, n_pixels).
    patches: (n_patches, n_pixels).
    selections: of these patches, by these atoms.
    learning_rate: eta.
    """
    steps = np.zeros_like(atoms)
    _add_gradient(atoms, patches, selections.atoms, selections.coefficients, steps)
    learned = atoms.copy()
    _step_and_normalise(selections.atoms, steps, learning_rate / patches.shape[0], learned)
    return learned


@njit(
    void(float32[:, ::1], float32[:, ::1], int32[:, ::1], float32[:, ::1], float32[:, ::1]),
    cache=True,
    nogil=True,
)
def _add_gradient(
    atoms: NDArray[np.float32],
    patches: NDArray[np.float32],
    selected: NDArray[np.int32],
    coefficients: NDArray[np.float32],
    steps: NDArray[np.float32],
) -> None:
    """Add sum_j kappa_jk r_j to the step of each atom k; see learned_atoms."""
    n_patches, n_selections = selected.shape
    residual = np.empty(patches.shape[1], np.float32)
    for i_patch in range(n_patches):
        residual[:] = patches[i_patch]
        for i in range(n_selections):
            coefficient = coefficients[i_patch, i]
            atom = atoms[selected[i_patch, i]]
            for i_pixel in range(residual.size):
                residual[i_pixel] -= coefficient * atom[i_pixel]
        for i in range(n_selections):
            coefficient = coefficients[i_patch, i]
            step = steps[selected[i_patch, i]]
            for i_pixel in range(residual.size):
                step[i_pixel] += coefficient * residual[i_pixel]


# "reassoc" lets the sum use the vector unit; the order is fixed once compiled, so that the same
# machine gives the same bits.
@njit(
    void(int32[:, ::1], float32[:, ::1], float64, float32[:, ::1]),
    cache=True,
    nogil=True,
    fastmath={"reassoc"},
)
def _step_and_normalise(
    selected: NDArray[np.int32],
    steps: NDArray[np.float32],
    rate: float,
    learned: NDArray[np.float32],
) -> None:
    """Move each selected row of learned by its step; see learned_atoms."""
    n_pixels = learned.shape[1]
    moved = np.empty(n_pixels, np.float64)
    is_done = np.zeros(learned.shape[0], np.bool_)
    for i_atom in selected.ravel():
        if is_done[i_atom]:
            continue
        is_done[i_atom] = True
        energy = 0.0
        for i_pixel in range(n_pixels):
            moved[i_pixel] = learned[i_atom, i_pixel] + rate * steps[i_atom, i_pixel]
            energy += moved[i_pixel] ** 2
        if energy > 0.0 and np.any(steps[i_atom]):
            moved /= np.sqrt(energy)
            for i_pixel in range(n_pixels):
                learned[i_atom, i_pixel] = moved[i_pixel]
