"""A session of frozen learners: eyes before pictures, while an examiner covers one of them."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import astuple, dataclass, replace
from functools import cache, cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.learners.correct_gaze import AHEAD_DEG, CheapestPair, CorrectGaze
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from experiment_manager import InProcessLoop
from eye_plant import Episode, Observation, StimulusSet, desired_vergence_deg
from eye_plant.gaze_error import gaze_error
from eye_plant.lens.lenses import LensState
from eye_plant.turns import eye_rotations, turned
from eye_plant.vergence import degrees_per_px
from lockstep import InputError
from sparse_coder import Encoding

Array = NDArray[np.float64]


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
_NO_SETTINGS: Mapping[str, Any] = MappingProxyType({})


@dataclass(frozen=True)
class Course:
    """Eyes over n iterations, n + 1 moments.

    Errors are (n + 1, 3), horizontal, vertical and torsional in deg, signed as GazeError's:
    eyes_deg, those of the eyes themselves; seen_deg, those that the pictures have, to which turned
    cameras and prisms add. lines_of_sight: (n + 1, 2, 3) unit vectors of both eyes. activations:
    (12,) at the end; missed_deg: angle between the left picture's centre and the target at the end;
    lenses: at the end, None of eyes without.
    """

    eyes_deg: Array
    seen_deg: Array
    lines_of_sight: Array
    activations: Array
    missed_deg: float = math.nan
    lenses: LensState | None = None

    @property
    def n_iterations(self) -> int:
        """How many commands the eyes made."""
        return len(self.eyes_deg) - 1

    @property
    def lens_state(self) -> LensState:
        """Lenses at the end, of eyes that have them."""
        assert self.lenses is not None
        return self.lenses


class Eyes:
    """Eyes before one picture at one distance, looked at in parts that differ in what they see.

    Each part is an episode that begins with the activations at which the one before ended. The eyes
    rest between commands, so nothing else carries over.
    """

    def __init__(
        self, session: "Session", i_picture: int, distance_m: float, activations: Sequence[float]
    ) -> None:
        """activations: (12,) at the beginning."""
        self._session, self._i_picture, self._distance_m = session, i_picture, distance_m
        self.activations = tuple(activations)

    def look(
        self,
        n_iterations: int,
        *,
        covered: str = "",
        prism: Prism = NO_PRISM,
        target_deg: Sequence[float] = AHEAD_DEG,
        settings: Mapping[str, Any] = _NO_SETTINGS,
    ) -> Course:
        """Let the eyes go on from where they are, for so many iterations.

        covered: the side of an eye that sees black; prism: added to the turn that the right camera
        has anyway; target_deg: azimuth and elevation from the left eye, of the saccades; settings:
        other parameters of the plant. Eyes that make saccades complete their last fixation, unless
        fewer iterations than one fixation has were asked for.
        """
        session = self._session
        n_iterations, n_targets = self._whole_fixations(n_iterations)
        session.loop.plant.reconfigure(session.settings(covered, prism) | dict(settings))
        episode = self._episode(n_iterations, tuple(target_deg) * n_targets)
        steps = session.loop.run_episode(episode, learning=False)
        observations = [step.observation for step in steps]
        self.activations = tuple(observations[-1].activations.tolist())
        return session.course(observations, self._i_picture)

    def before(self, distance_m: float) -> "Eyes":
        """Return the eyes as they are now, with the picture at another distance."""
        return Eyes(self._session, self._i_picture, distance_m, self.activations)

    def code(self) -> Encoding:
        """Return the code of what the eyes see now, with the learners' own eyes; none moves."""
        loop = self._session.loop
        loop.plant.reconfigure({})
        observation = loop.plant.begin(self._episode(1, ()))
        assert observation.pictures is not None
        left, right = observation.pictures
        return loop.coder.encode(left, right, observation.apart)

    def _episode(self, n_iterations: int, targets_deg: Sequence[float]) -> Episode:
        return Episode.alone(
            self._i_picture, self._distance_m, self.activations, n_iterations, targets_deg
        )

    def _whole_fixations(self, n_iterations: int) -> tuple[int, int]:
        """Return how many iterations there are, and how many targets."""
        per_fixation = self._session.learners.manager.fixation_iterations
        if not per_fixation:
            return n_iterations, 0
        n_targets = math.ceil(n_iterations / per_fixation)
        return max(n_iterations, n_targets * per_fixation if n_targets > 1 else 0), n_targets


class Session:
    """Frozen learners and the pictures that they are shown.

    correct: (parallax in m) -> activations with which their eyes look correctly.
    """

    def __init__(self, learners: FrozenLearners, loop: InProcessLoop, stimuli: StimulusSet) -> None:
        """loop: of the learners, before the stimuli."""
        self.learners, self.loop, self._stimuli = learners, loop, stimuli
        manager = learners.manager
        turns_deg = learners.plant.camera.turns_deg
        self.correct = cache(
            lambda parallax_m: CorrectGaze(manager, learners.plant.mechanics, turns_deg, parallax_m)
        )

    @property
    def n_pictures(self) -> int:
        """How many pictures or stereograms there are."""
        return self._stimuli.n_pictures

    @cached_property
    def px_deg(self) -> float:
        """Visual angle of one pixel."""
        return degrees_per_px(self.learners.plant.camera.focal_length_px)

    def eyes(self, i_picture: int, distance_m: float, error_deg: float = 0.0) -> Eyes:
        """Return eyes before a picture with a horizontal error; see CorrectGaze.activations."""
        correct = self.correct(self.parallax_m(i_picture))
        return Eyes(self, i_picture, distance_m, correct.activations(distance_m, error_deg))

    def shows(self, distance_m: float) -> bool:
        """Whether the plant shows a plane at a distance, to which its muscles must converge."""
        plant = self.learners.plant
        desired_deg = desired_vergence_deg(distance_m, plant.mechanics.baseline_m)
        try:
            plant.cost_of_vergence.least_w(desired_deg)
        except InputError:
            return False
        return True

    def eyes_at_rest(self, i_picture: int, distance_m: float) -> Eyes:
        """Return eyes before a picture, all muscles at their tonic level, wherever they look."""
        first = self.loop.plant.oculomotor.tonic_activations
        return Eyes(self, i_picture, distance_m, first.tolist())

    def eyes_as_left(self, i_picture: int, distance_m: float) -> Eyes:
        """Return eyes before a picture, as the run's last training episode left them."""
        first = self.loop.plant.oculomotor.tonic_activations.copy()
        indices = self.learners.manager.space.turning.indices
        first[indices] = self.learners.left[: len(indices)]
        return Eyes(self, i_picture, distance_m, first.tolist())

    def eyes_as_healthy(self, i_picture: int, distance_m: float) -> Eyes:
        """Return eyes with the activations with which those without settings look correctly."""
        return Eyes(self, i_picture, distance_m, self._healthy.activations(distance_m))

    def eyes_at_vergence(self, i_picture: int, distance_m: float, error_deg: float) -> Eyes:
        """Return eyes at the cheapest pair for a vergence error; see CheapestPair.activations."""
        first = self._cheapest_pair.activations(distance_m, error_deg)
        return Eyes(self, i_picture, distance_m, first)

    @cached_property
    def _healthy(self) -> CorrectGaze:
        healthy = replace(self.learners, settings={})
        turns_deg = self.learners.plant.camera.turns_deg
        return CorrectGaze(healthy.manager, healthy.plant.mechanics, turns_deg)

    @cached_property
    def _cheapest_pair(self) -> CheapestPair:
        return CheapestPair(self.learners.plant.mechanics)

    def parallax_m(self, i_picture: int) -> float:
        """Return the parallax of a stereogram on the plane, 0 of a picture."""
        i_stereogram = i_picture - len(self._stimuli.all)
        if i_stereogram < 0:
            return 0.0
        parallax = self._stimuli.stereograms[i_stereogram].parallax
        return parallax * self.learners.plant.camera.plane_size_m

    def settings(self, covered: str, prism: Prism) -> dict[str, Any]:
        """Return the plant's parameters that a cover and a prism change."""
        own = self.learners.plant.camera
        settings: dict[str, Any] = {
            f"camera.right_{name}": getattr(own, f"right_{name}") + angle_deg
            for name, angle_deg in vars(prism).items()
            if angle_deg
        }
        return settings | ({f"camera.{covered}_occluded": True} if covered else {})

    def course(self, observations: Sequence[Observation], i_picture: int) -> Course:
        """Return what the eyes did, from observations with the cameras as they are now."""
        plant, parallax_m = self.loop.plant, self.parallax_m(i_picture)
        turns_deg = plant.config.camera.turns_deg
        positions_m = plant.oculomotor.eye_positions_m()
        eyes_deg: list[tuple[float, ...]] = []
        seen_deg: list[tuple[float, ...]] = []
        lines_of_sight = []
        for observation in observations:
            rotations = eye_rotations(observation.state.eye_angles_rad)
            cameras = turned(rotations, turns_deg)
            distance_m = observation.episode.object_distance_m
            for errors_deg, axes in ((eyes_deg, rotations), (seen_deg, cameras)):
                error = gaze_error(positions_m, axes, distance_m, parallax_m)
                errors_deg.append(astuple(error))
            lines_of_sight.append(rotations[:, :, 0])
        end = observations[-1]
        return Course(
            np.array(eyes_deg),
            np.array(seen_deg),
            np.array(lines_of_sight),
            end.state.activations,
            float(np.hypot(*end.truth.target_deg)),
            end.lenses,
        )


@contextmanager
def session_of(learners: FrozenLearners, shown: Shown, n_pictures: int) -> Iterator[Session]:
    """Yield a session with what is shown, n_pictures of it unless shown.n_most says how many.

    Raises InputError for pictures and learners that cannot be used.
    """
    stimuli = shown.load(learners.plant.stimuli, n_pictures)
    with learners.loop(stimuli) as loop:
        yield Session(learners, loop, stimuli)


def check_looks_at_targets(learners: FrozenLearners, shown: Shown, option: str) -> None:
    """Raise InputError, which names the option, unless the learners can look at targets."""
    if not learners.manager.fixation_iterations:
        raise InputError(
            f"{option}: expected eyes that make saccades, as those of profile gaze, got a run with "
            "fixation_iterations 0"
        )
    check_shows_pictures(shown, option)


def check_shows_pictures(shown: Shown, option: str) -> None:
    """Raise InputError, which names the option, for stereograms."""
    if shown.random_dots or shown.stereograms is not None:
        raise InputError(f"{option}: expected stimuli on a plane, got stereograms")


def check_has_lenses(learners: FrozenLearners, option: str) -> None:
    """Raise InputError, which names the option, unless the eyes have lenses."""
    if not learners.manager.space.has_lenses:
        raise InputError(
            f"{option}: expected eyes with lenses, as those of profile triad, got a run with "
            f"command_space {learners.manager.command_space}"
        )


def is_fused(errors_deg: Array, px_deg: float) -> NDArray[np.bool_]:
    """Return whether horizontal and vertical error are both below a pixel, (...,).

    errors_deg: (..., 3).
    """
    return np.asarray((np.abs(errors_deg[..., :2]) < px_deg).all(axis=-1))
