"""Sherrington's law: whether one of two antagonists is silent, and whether the right one."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from experiment_manager.measures.metrics import antagonist_names
from lockstep.command_space import ALL_MUSCLES, COMMAND_SPACES, MUSCLE_NAMES

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Silence:
    """Of two antagonists, or of all pairs together.

    share_silent, share_silent_in_optimum: of the gazes at which one of both is silent;
    share_optimally_silent: of the muscles that are silent with the least energy, how many are
    silent in these eyes, over all gazes; None where none is; n_silent_in_optimum: muscles that are,
    over all gazes.
    """

    share_silent: float
    share_silent_in_optimum: float
    share_optimally_silent: float | None
    n_silent_in_optimum: int


def silences(is_silent: NDArray[np.bool_], optimum: NDArray[np.bool_]) -> dict[str, Silence]:
    """Return the measures of each two antagonists, and of "all".

    is_silent: (n, n_pictures, 12) of the eyes at n gazes; optimum: (n, 12) of the least energy.
    """
    pairs = antagonist_names(COMMAND_SPACES[ALL_MUSCLES])
    indices = np.array([[MUSCLE_NAMES.index(name) for name in names] for names in pairs])
    chosen = {"-".join(names): i[None] for names, i in zip(pairs, indices, strict=True)}
    return {
        name: _silence(is_silent[..., i], optimum[..., i])
        for name, i in (chosen | {"all": indices}).items()
    }


def _silence(is_silent: NDArray[np.bool_], optimum: NDArray[np.bool_]) -> Silence:
    """Return the measures of k pairs; is_silent: (n, n_pictures, k, 2), optimum: (n, k, 2)."""
    both = np.broadcast_to(optimum[:, None], is_silent.shape)
    n_cases = int(optimum.sum())
    return Silence(
        share_silent=float(is_silent.any(axis=-1).mean()),
        share_silent_in_optimum=float(optimum.any(axis=-1).mean()),
        share_optimally_silent=float(is_silent[both].mean()) if n_cases else None,
        n_silent_in_optimum=n_cases,
    )
