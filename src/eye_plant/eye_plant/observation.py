"""What the plant gives out at one moment."""

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eye_plant.episode import Episode
from eye_plant.ground_truth import GroundTruth
from eye_plant.mechanics.oculomotor import OculomotorState
from lockstep import CommandSpace
from lockstep.optics import Pinhole
from lockstep.randomness import Moment


@dataclass(frozen=True)
class Seen:
    """Observation `iteration` of an episode, 0 to n_iterations, of eyes or of a robot's head.

    pictures: (2, height_px, width_px) uint8, left then right, valid until the next observation is
    made; None in the last observation, which nobody answers.
    """

    episode: Episode
    iteration: int
    pictures: np.ndarray | None

    @property
    def number(self) -> int:
        """Number of the observation within the run."""
        return self.episode.first_observation + self.iteration

    @property
    def moment(self) -> Moment:
        """Which observation it is, for what is drawn at random."""
        return self.episode.moment(self.iteration)

    @property
    def training_iteration(self) -> int:
        """Training iterations of the run before this observation."""
        return self.moment.training_iteration

    def episode_values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.EPISODE_NAMES."""
        episode = self.episode
        return (
            episode.phase,
            episode.test,
            episode.trial,
            episode.episode,
            self.iteration,
            self.training_iteration,
            self.number,
        )

    def _numbers(self) -> tuple[float, ...]:
        """Return the first values of ground truth, which are known of every plant."""
        return (*self.episode_values(), self.episode.stimulus)


@dataclass(frozen=True)
class Observation(Seen):
    """An observation of two eyes; their pictures have the size of the region of interest.

    felt: (12,) activations as they are felt.
    """

    state: OculomotorState
    truth: GroundTruth
    felt: np.ndarray

    # Eyes do not know theirs.
    cameras: ClassVar[tuple[Pinhole, Pinhole] | None] = None

    def commanded(self, space: CommandSpace) -> np.ndarray:
        """Return the activations (n_muscles,) of the muscles that a space commands."""
        return self.state.activations[space.indices]

    def rates_w(self, space: CommandSpace) -> np.ndarray:
        """Return the settled metabolic rates (n_muscles,) of those muscles."""
        return self.state.metabolic_rate_w[space.indices]

    @property
    def given_target_deg(self) -> tuple[float, float]:
        """Place in the left picture to look at, sideways and up; NaN unless a new one is given."""
        is_new = self.episode.begins_fixation(self.iteration)
        return self.truth.target_deg if is_new else (math.nan, math.nan)

    def ground_truth_values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.GROUND_TRUTH_NAMES."""
        truth = self.truth
        return (
            *self._numbers(),
            self.episode.object_distance_m,
            truth.vergence_deg,
            truth.desired_vergence_deg,
            truth.vergence_error_deg,
            truth.gaze_error.vertical_deg,
            truth.gaze_error.torsional_deg,
            truth.version_deg,
            sum(truth.elevation_deg) / 2.0,
            *truth.torsion_deg,
            *truth.deviations_deg,
            truth.metabolic_rate_w,
            truth.initial_metabolic_rate_w,
            truth.optimal_metabolic_rate_w,
            *truth.target_deg,
        )
