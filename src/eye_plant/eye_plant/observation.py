"""What the plant gives out at one moment."""

import math
from dataclasses import dataclass

import numpy as np

from eye_plant.episode import Episode
from eye_plant.gaze_error import GazeError
from eye_plant.mechanics.oculomotor import OculomotorState
from lockstep.wire.topics import TRAINING


@dataclass(frozen=True)
class GroundTruth:
    """What only an experimenter knows; learners never see it.

    adduction_deg, elevation_deg, torsion_deg: of the left and the right eye, torsion in Listing's
    coordinates; gaze_error: of the plane at the left fovea; desired_vergence_deg: of the pair that
    of the plane's centre (K17 eq. 6), else that with which the right eye would look where the left
    one does;
    metabolic_rate_w is C, the charged settled rate of both eyes; initial_... is C_0, optimal_... is
    C* (K17 eq. 8).
    """

    adduction_deg: tuple[float, float]
    elevation_deg: tuple[float, float]
    torsion_deg: tuple[float, float]
    gaze_error: GazeError
    desired_vergence_deg: float
    metabolic_rate_w: float
    initial_metabolic_rate_w: float
    optimal_metabolic_rate_w: float
    target_deg: tuple[float, float] = (0.0, 0.0)

    @property
    def vergence_deg(self) -> float:
        """Sum of both eyes' adduction."""
        return sum(self.adduction_deg)

    @property
    def version_deg(self) -> float:
        """Where both eyes look together, half the difference of their adduction; right positive."""
        left_deg, right_deg = self.adduction_deg
        return (left_deg - right_deg) / 2.0

    @property
    def deviations_deg(self) -> tuple[float, float]:
        """How far each eye is turned in beyond the fixation of the plane's centre (K17 eq. 6).

        An eye behind a cover deviates by its phoria; below 0 it is turned out.
        """
        left_deg, right_deg = self.adduction_deg
        half_deg = self.desired_vergence_deg / 2.0
        return left_deg - half_deg, right_deg - half_deg

    @property
    def vergence_error_deg(self) -> float:
        """Desired minus actual vergence (K17 eq. 7): positive when the eyes converge too little."""
        return self.desired_vergence_deg - self.vergence_deg


@dataclass(frozen=True)
class Observation:
    """Observation `iteration` of an episode, 0 to n_iterations.

    pictures: (2, height_px, width_px) uint8, left then right, valid until the next observation is
    made; None in the last observation, which nobody answers.
    """

    episode: Episode
    iteration: int
    pictures: np.ndarray | None
    state: OculomotorState
    truth: GroundTruth

    @property
    def number(self) -> int:
        """Number of the observation within the run."""
        return self.episode.first_observation + self.iteration

    @property
    def training_iteration(self) -> int:
        """Training iterations of the run before this observation."""
        in_training = self.episode.phase == TRAINING
        return self.episode.training_iteration + (self.iteration if in_training else 0)

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

    @property
    def given_target_deg(self) -> tuple[float, float]:
        """Place in the left picture to look at, sideways and up; NaN unless a new one is given."""
        is_new = self.episode.begins_fixation(self.iteration)
        return self.truth.target_deg if is_new else (math.nan, math.nan)

    def ground_truth_values(self) -> tuple[float, ...]:
        """Return the values of lockstep.wire.topics.GROUND_TRUTH_NAMES."""
        truth = self.truth
        return (
            *self.episode_values(),
            self.episode.stimulus,
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
