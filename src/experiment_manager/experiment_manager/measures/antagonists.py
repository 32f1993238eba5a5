"""How two antagonists of an eye share their work: Sherrington's law of reciprocal innervation.

The law is a graded one: as a muscle contracts, its antagonist relaxes (Sherrington 1893). That one
of two muscles is silent does not show it, and that both are shows eyes at rest. So both are
counted apart, and the slope of the antagonist over the agonist is measured.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from experiment_manager.measures.criteria import Criteria
from experiment_manager.measures.results import ActivePairs, AntagonistPair
from experiment_manager.measures.trials import Trials
from experiment_manager.measures.yoked import SharedChange, shared_change
from lockstep import COMMAND_SPACES, PAIR, SIDES, CommandSpace
from lockstep.command_space import MUSCLES

# A muscle is silent below it, K17's least charged activation.
_SILENT = 0.005


def antagonist_names(space: CommandSpace) -> list[tuple[str, str]]:
    """Return the names of antagonists that both have a command."""
    if space.turning == COMMAND_SPACES[PAIR]:
        first, second = space.turning.names
        return [(first, second)]
    pairs = [
        (f"{side}_{first}", f"{side}_{second}")
        for side in SIDES
        for first, second in zip(MUSCLES[::2], MUSCLES[1::2], strict=True)
    ]
    return [pair for pair in pairs if set(pair) <= set(space.names)]


def silent_below(criteria: Criteria) -> float:
    """Return the activation above its floor below which a muscle is silent."""
    return max(criteria.silent_activation, _SILENT)


def active_pairs(is_active: NDArray[np.bool_]) -> ActivePairs | None:
    """Return the shares of pairs (..., 2) of which both, one or none is active; None without."""
    n_active = is_active.sum(axis=-1)
    if not n_active.size:
        return None
    none, one, both = (float((n_active == n).mean()) for n in range(3))
    return ActivePairs(both=both, one=one, none=none)


def reciprocity(activations: np.ndarray, silent: float) -> SharedChange:
    """Return how the less active of two antagonists changes with the more active one.

    activations: (n, k, 2) of k pairs in n cases; those count in which one of both is active.
    Changes are those around the means of each pair. Slope -1: one relaxes as much as the other
    contracts; 0: the antagonist does not change, as where it is always silent; above 0: both
    contract together. nan where the agonist does not vary.
    """
    is_active = activations.max(axis=-1) >= silent
    pair = np.nonzero(is_active)[1]
    return shared_change(np.sort(activations[is_active], axis=1)[:, ::-1].T, pair)


def antagonist_measures(trials: Trials, criteria: Criteria) -> dict[str, Any]:
    """Return what antagonists do in the end, by the names of fields of SetSummary.

    Nothing of joints, which have none, and without a trial.
    """
    pairs = antagonist_names(trials.space)
    if not pairs or not len(trials.trial):
        return {}
    floors = dict(zip(trials.space.turning.names, criteria.lowest_activations, strict=True))
    # Above the least that commands may set, (n_trials, n_pairs, 2).
    values = np.stack(
        [[trials.column(name)[:, -1] - floors[name] for name in names] for names in pairs]
    ).transpose(2, 0, 1)
    silent = silent_below(criteria)
    is_active = values[~np.isnan(values).any(axis=(1, 2))] >= silent
    n_active = is_active.sum(axis=(1, 2))
    is_counted = n_active.size and not trials.is_of_pair
    return {
        "antagonists_active": active_pairs(is_active),
        "median_active_muscles": float(np.median(n_active)) if is_counted else None,
        "antagonists": {
            "-".join(names): _antagonist_pair(values[:, i], trials.object_distance_m, silent)
            for i, names in enumerate(pairs)
        },
    }


def _antagonist_pair(values: np.ndarray, distance_m: np.ndarray, silent: float) -> AntagonistPair:
    """Return how two antagonists share their work; values (n_trials, 2), nan of unknown ones."""
    is_known = ~np.isnan(values).any(axis=1)
    known, known_m = values[is_known], distance_m[is_known]
    slope = reciprocity(known[:, None], silent).slope
    return AntagonistPair(
        active=active_pairs(known >= silent),
        median_co_contraction=float(np.median(known.min(axis=1))) if len(known) else None,
        reciprocity_slope=float(slope) if np.isfinite(slope) else None,
        active_by_distance={
            f"{d:g}": active_pairs(known[known_m == d] >= silent)
            for d in np.unique(distance_m).tolist()
        },
    )
