"""The landscape of the reward: how well pictures are coded, over the vergence error."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.learners.basis_functions import left_share
from eye_plant import Episode, EyePlant, Inverse, Observation, desired_vergence_deg
from eye_plant.inverse.pair import FULL_RANGE
from eye_plant.mechanics.model import MechanicsConfig
from lockstep import InputError
from sparse_coder import SparseCoder

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RewardLandscape:
    """What a frozen dictionary makes of pictures seen with wrong vergence.

    vergence_error_deg: (n_errors,). reconstruction_error: coarse and fine, (n_errors, 2), mean over
    pictures and distances; nan where no muscle activation gives the vergence, or none at which the
    eyes have one rest. left_share: of the left eye in the code of all these pictures, 0.5 where
    neither eye is suppressed. use: of each atom in it, (2, n_bases), the share in its scale's
    squared coefficients.
    """

    vergence_error_deg: Array
    reconstruction_error: Array
    left_share: float
    use: Array

    @property
    def total_error(self) -> Array:
        """Reconstruction error of both scales together, (n_errors,): the reward, negated."""
        return self.reconstruction_error.sum(axis=1)

    @property
    def depth(self) -> float:
        """How much the best vergence error saves against the mean of all, as a share; 0 is flat."""
        total = self.total_error[~np.isnan(self.total_error)]
        return float(1.0 - total.min() / total.mean()) if len(total) else float("nan")


def reward_landscape(
    plant: EyePlant,
    mechanics: MechanicsConfig,
    coder: SparseCoder,
    *,
    stimuli: Sequence[int],
    distances_m: Sequence[float],
    vergence_errors_deg: Sequence[float],
) -> RewardLandscape:
    """Return the landscape over the given stimuli, distances and errors, nothing being learned.

    mechanics: the plant's. The eyes are held at the cheapest pair of activations for each vergence,
    so that eyes of unequal muscles point where these let them.
    """
    if not (len(stimuli) and len(distances_m) and len(vergence_errors_deg)):
        raise InputError("expected at least one stimulus, distance and vergence error, got none")
    inverse = Inverse(mechanics)
    errors = np.full((len(vergence_errors_deg), len(distances_m), len(stimuli), 2), np.nan)
    features = np.zeros((2, coder.config.n_bases))
    for i_error, error_deg in enumerate(vergence_errors_deg):
        for i_distance, distance_m in enumerate(distances_m):
            desired_deg = desired_vergence_deg(distance_m, mechanics.baseline_m)
            try:
                inverse.check(desired_deg)  # without which the plant shows nothing there
                pair = inverse.activation_pair(desired_deg - error_deg, 0.0, FULL_RANGE)
            except InputError:
                continue
            for i_stimulus, stimulus in enumerate(stimuli):
                seen = _look(plant, stimulus, distance_m, pair)
                assert seen.pictures is not None
                encoding = coder.encode(*seen.pictures)
                errors[i_error, i_distance, i_stimulus] = encoding.reconstruction_error
                features += encoding.features
    reached = ~np.isnan(errors).any(axis=(1, 2, 3))
    means = np.full((len(errors), 2), np.nan)
    means[reached] = errors[reached].mean(axis=(1, 2))
    return RewardLandscape(
        np.asarray(vergence_errors_deg, dtype=np.float64),
        means,
        left_share(features, coder.atoms()),
        features / np.maximum(features.sum(axis=1, keepdims=True), np.finfo(float).tiny),
    )


def _look(
    plant: EyePlant, stimulus: int, distance_m: float, activations: tuple[float, float]
) -> Observation:
    """Return what the eyes see that are held at the activations of (medial, lateral) recti."""
    of_all = plant.oculomotor.activations_from(*activations).tolist()
    return plant.begin(Episode.alone(stimulus, distance_m, of_all, n_iterations=1))
