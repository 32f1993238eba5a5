"""What the plant gives out at one moment."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from eye_plant.episode import Episode
from eye_plant.ground_truth import GroundTruth
from eye_plant.lens.lenses import LensState
from eye_plant.mechanics.oculomotor import OculomotorState
from lockstep import CommandSpace
from lockstep.optics import Pinhole
from lockstep.randomness import Moment
from lockstep.wire.topics import GIVEN_TARGET_NAMES

NOT_GIVEN_DEG = (float("nan"),) * len(GIVEN_TARGET_NAMES)


def with_lenses(activations: np.ndarray, lenses: LensState | None) -> np.ndarray:
    """Return activations (12,) of the muscles that turn the eyes, and the others' after them."""
    return activations if lenses is None else np.append(activations, lenses.activations)


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

    felt: (12,) activations as they are felt, or (16,) with those of lenses and pupils; lenses: None
    of eyes without; apart: of each scale with a picture of its own both eyes' (2, height_px,
    width_px), none in the last observation.
    """

    state: OculomotorState
    truth: GroundTruth
    felt: np.ndarray
    lenses: LensState | None = None
    apart: tuple[np.ndarray, ...] = ()

    # Eyes do not know theirs.
    cameras: ClassVar[tuple[Pinhole, Pinhole] | None] = None

    def commanded(self, space: CommandSpace) -> np.ndarray:
        """Return the activations (n_muscles,) of the muscles that a space commands."""
        return self.activations[space.indices]

    @property
    def activations(self) -> np.ndarray:
        """Activations of all muscles, (12,) or (16,) with those of lenses and pupils."""
        return with_lenses(self.state.activations, self.lenses)

    def rates_w(self, space: CommandSpace) -> np.ndarray:
        """Return the settled metabolic rates (n_muscles,) of those muscles."""
        return self.all_rates_w[space.indices]

    @property
    def all_rates_w(self) -> np.ndarray:
        """Settled metabolic rates as of `activations`; ours: of muscles within the eye 0."""
        rates_w = self.state.metabolic_rate_w
        n_more = len(self.lenses.activations) if self.lenses else 0
        return np.append(rates_w, np.zeros(n_more)) if n_more else rates_w

    def eye_state_values(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the values of lockstep.wire.topics.eye_state_names, and their rates of change."""
        state, lenses = self.state, self.lenses
        angles_rad, velocities_rad_s = state.eye_angles_rad, state.eye_velocities_rad_s
        if lenses is None:
            return angles_rad.ravel(), velocities_rad_s.ravel()
        # The focus changes as the accommodation does.
        rate_d_s = lenses.accommodation_d_s
        values = np.stack([lenses.accommodation_d, lenses.focus_d, lenses.pupil_m], axis=1)
        rates = np.stack([rate_d_s, rate_d_s, lenses.pupil_m_s], axis=1)
        return (
            np.append(angles_rad, values),
            np.append(velocities_rad_s, rates),
        )

    @property
    def given_target_deg(self) -> tuple[float, ...]:
        """The values of lockstep.wire.topics.GIVEN_TARGET_NAMES: where either picture has the
        place to look at, sideways and up; NaN unless a new one is given.
        """
        is_new = self.episode.begins_fixation(self.iteration)
        return self.truth.target_places_deg if is_new else NOT_GIVEN_DEG

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
            *truth.target_places_deg,
        )
