"""An examination room: eyes look at a picture while the examiner covers one, or holds a prism."""

import dataclasses
import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.correct_fixation import CorrectFixation
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from active_binocular_vision.learners.viewing import Viewing
from experiment_manager.in_process.loop import InProcessLoop
from eye_plant import Observation, StimulusSet
from eye_plant.gaze_error import gaze_error
from eye_plant.turns import eye_rotations, turned
from eye_plant.vergence import degrees_per_px
from sparse_coder import Encoding

Array = NDArray[np.float64]

# Where saccades go: straight ahead of the left eye, azimuth and elevation.
_AHEAD_DEG = (0.0, 0.0)


@dataclass(frozen=True)
class Prism:
    """What turns the right eye's picture, as the settings of its camera of the same names do.

    rotation_deg: toward the nose; elevation_deg: up; roll_deg: the upper side toward the nose. The
    pictures of both eyes match where the right eye has turned as far the other way.
    """

    rotation_deg: float = 0.0
    elevation_deg: float = 0.0
    roll_deg: float = 0.0


NO_PRISM = Prism()


@dataclass(frozen=True)
class Course:
    """Eyes over n iterations, n + 1 moments.

    Errors are (n + 1, 3), horizontal, vertical and torsional in deg, signed as GazeError's:
    eyes_deg, those of the eyes themselves; seen_deg, those that the pictures have, to which turned
    cameras and prisms add. lines_of_sight: (n + 1, 2, 3) unit vectors of both eyes.
    """

    eyes_deg: Array
    seen_deg: Array
    lines_of_sight: Array

    @property
    def n_iterations(self) -> int:
        """How many commands the eyes made."""
        return len(self.eyes_deg) - 1

    def then(self, *later: "Course") -> "Course":
        """Return one course with those that follow, each of which begins where this one ends."""
        parts = (self, *later)
        joined = {
            f.name: np.concatenate(
                [*(getattr(part, f.name)[:-1] for part in parts), getattr(parts[-1], f.name)[-1:]]
            )
            for f in dataclasses.fields(self)
        }
        return Course(**joined)


class Sitting:
    """Eyes before one picture at one distance."""

    def __init__(
        self, room: "Room", i_picture: int, distance_m: float, activations: Sequence[float]
    ) -> None:
        """activations: (12,) at the beginning."""
        self._plant, self._parallax_m = room.loop.plant, room.parallax_m(i_picture)
        self._viewing = Viewing(room.loop, i_picture, distance_m, activations)
        self._own = room.learners.plant.camera
        self._fixation_iterations = room.learners.manager.fixation_iterations

    def look(self, n_iterations: int, *, covered: str = "", prism: Prism = NO_PRISM) -> Course:
        """Let the eyes go on from where they are, for so many iterations.

        covered: the side of an eye that sees black; prism: added to the turn that the right camera
        has anyway. Eyes that make saccades complete their last fixation, unless fewer iterations
        than one fixation has were asked for.
        """
        n_iterations, n_targets = self._whole_fixations(n_iterations)
        observations = self._viewing.look(
            n_iterations, self._settings(covered, prism), _AHEAD_DEG * n_targets
        )
        return self._course(observations)

    def code(self) -> Encoding:
        """Return the code of what the eyes see now."""
        return self._viewing.code()

    def _whole_fixations(self, n_iterations: int) -> tuple[int, int]:
        """Return how many iterations there are, and how many targets."""
        per_fixation = self._fixation_iterations
        if not per_fixation:
            return n_iterations, 0
        n_targets = math.ceil(n_iterations / per_fixation)
        return max(n_iterations, n_targets * per_fixation if n_targets > 1 else 0), n_targets

    def _settings(self, covered: str, prism: Prism) -> dict[str, Any]:
        settings: dict[str, Any] = {
            f"camera.right_{name}": getattr(self._own, f"right_{name}") + angle_deg
            for name, angle_deg in vars(prism).items()
            if angle_deg
        }
        if covered:
            settings[f"camera.{covered}_occluded"] = True
        return settings

    def _course(self, observations: Sequence[Observation]) -> Course:
        turns_deg = self._plant.config.camera.turns_deg
        positions_m = self._plant.oculomotor.eye_positions_m()
        eyes_deg: list[tuple[float, ...]] = []
        seen_deg: list[tuple[float, ...]] = []
        lines_of_sight = []
        for observation in observations:
            rotations = eye_rotations(observation.state.eye_angles_rad)
            cameras = turned(rotations, turns_deg)
            distance_m = observation.episode.object_distance_m
            for errors_deg, axes in ((eyes_deg, rotations), (seen_deg, cameras)):
                error = gaze_error(positions_m, axes, distance_m, self._parallax_m)
                errors_deg.append(dataclasses.astuple(error))
            lines_of_sight.append(rotations[:, :, 0])
        return Course(np.array(eyes_deg), np.array(seen_deg), np.array(lines_of_sight))


class Room:
    """Learners and the pictures of one examination."""

    def __init__(self, learners: FrozenLearners, loop: InProcessLoop, stimuli: StimulusSet) -> None:
        """loop: of the learners, before the stimuli."""
        self.learners, self.loop, self._stimuli = learners, loop, stimuli
        self._correct: dict[float, CorrectFixation] = {}

    @property
    def n_pictures(self) -> int:
        """How many pictures or stereograms there are."""
        return len(self._stimuli.all) + len(self._stimuli.stereograms)

    @cached_property
    def px_deg(self) -> float:
        """Visual angle of one pixel."""
        return degrees_per_px(self.learners.plant.camera.focal_length_px)

    def seat(self, i_picture: int, distance_m: float, error_deg: float = 0.0) -> Sitting:
        """Return eyes before a picture with a horizontal error; see CorrectFixation.activations."""
        parallax_m = self.parallax_m(i_picture)
        manager = self.learners.manager
        if parallax_m not in self._correct:
            self._correct[parallax_m] = CorrectFixation(
                manager, manager.mechanics, manager.camera.turns_deg, parallax_m
            )
        first = self._correct[parallax_m].activations(distance_m, error_deg)
        return Sitting(self, i_picture, distance_m, first)

    def seat_at_rest(self, i_picture: int, distance_m: float) -> Sitting:
        """Return eyes before a picture, all muscles at their tonic level, wherever they look."""
        first = self.loop.plant.oculomotor.tonic_activations
        return Sitting(self, i_picture, distance_m, first.tolist())

    def parallax_m(self, i_picture: int) -> float:
        """Return the parallax of a stereogram on the plane, 0 of a picture."""
        i_stereogram = i_picture - len(self._stimuli.all)
        if i_stereogram < 0:
            return 0.0
        parallax = self._stimuli.stereograms[i_stereogram].parallax
        return parallax * self.learners.plant.camera.plane_size_m


@contextmanager
def examination_room(learners: FrozenLearners, shown: Shown, n_pictures: int) -> Iterator[Room]:
    """Yield a room with what is shown, n_pictures of it unless shown.n_most says how many.

    Raises InputError for pictures and learners that cannot be used.
    """
    stimuli = shown.load(learners.plant.stimuli, n_pictures)
    with learners.loop(stimuli) as loop:
        yield Room(learners, loop, stimuli)


def is_fused(errors_deg: Array, px_deg: float) -> NDArray[np.bool_]:
    """Return whether horizontal and vertical error are both below a pixel, (...,).

    errors_deg: (..., 3).
    """
    return np.asarray((np.abs(errors_deg[..., :2]) < px_deg).all(axis=-1))
