"""With what gaze an episode begins: drawn for training, the same for each test's trials.

Eyes that one command turns alike begin as K17's, looking straight ahead at another distance than
the plane's. Eyes with a command for each muscle begin with errors of their own about all axes that
the commands turn, and look aside; those that make saccades have gaze targets. Some of them begin
with errors in one corner of the ranges, another one in each run, and its opposite in tests: were
the mean of all starts the right posture, eyes would learn that without a reward.
"""

import functools
import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from experiment_manager.config import OF_CODE, ProtocolConfig
from eye_plant import GazeInverse, Inverse, desired_vergence_deg
from eye_plant import fixation_distance_m as distance_of_vergence_m
from eye_plant.inverse.gaze import ERRORS, TURNED_ANGLES
from eye_plant.lens.config import LensesConfig
from eye_plant.lens.lenses import Lenses
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.turns import NO_TURNS_DEG, TurnsDeg
from lockstep import PAIR, SIDES, generator

Activations = tuple[float, ...]
ActivationsOfVergence = Callable[[float, float], Activations]

# Of the largest errors, those with which episodes begin in the corner.
_CORNER = (0.7, 1.0)
_MOST_DRAWS = 1000
_LARGEST_OF_CODE_DEG = 2.0
_LENSES = LensesConfig()


@dataclass(frozen=True)
class Condition:
    """Where a test trial's plane stands, and the vergence error at its start.

    start: its number, where first errors are drawn.
    """

    object_distance_m: float
    start_error_deg: float
    start: int = 0


def conditions(config: ProtocolConfig, baseline_m: float) -> tuple[Condition, ...]:
    """Return the conditions of a test: distances x first errors.

    Of the pair and of joints they are `start_errors_deg`; of muscles with a command each they are
    drawn.
    """
    if config.turning_space in TURNED_ANGLES:
        planes_m = np.repeat(config.test_distances_m, config.n_starts_per_distance).tolist()
        return tuple(
            Condition(distance_m, _first_error_deg(config, start), start)
            for start, distance_m in enumerate(planes_m)
        )
    return tuple(
        Condition(distance_m, error_deg)
        for distance_m in config.test_distances_m
        for error_deg in start_errors_deg(config, desired_vergence_deg(distance_m, baseline_m))
    )


def start_errors_deg(config: ProtocolConfig, desired_deg: float) -> list[float]:
    """Return the start errors of the pair's trials before an object with a desired vergence.

    Of K17's text: from least_start_error_deg to the largest whole degree that leaves the initial
    vergence 0 or more (D11; "the smallest possible initial angle of the eyes to zero"). Of the
    authors' code (2016 to 2021): thirds of -2 deg and of v = min(2 deg, desired vergence), and 0,
    which their measures leave out.
    """
    if config.start_errors == OF_CODE:
        largest_deg = min(_LARGEST_OF_CODE_DEG, desired_deg)
        return [-2.0, -4.0 / 3.0, -2.0 / 3.0, *(k / 3.0 * largest_deg for k in range(4))]
    return [float(e) for e in range(config.least_start_error_deg, math.floor(desired_deg) + 1)]


def _first_error_deg(config: ProtocolConfig, start: int) -> float:
    return draw_angles_deg(config, _draw_of(config, start), of_tests=True)["horizontal"]


class PairStarts:
    """Vergences, and fractions of the line of pairs that give them; no gaze targets."""

    # Of an Episode: what a start is.
    argument = "activations"

    def __init__(
        self, config: ProtocolConfig, baseline_m: float, activations: ActivationsOfVergence
    ) -> None:
        """activations: (vergence_deg, fraction in [0, 1]) -> those of the twelve muscles."""
        self._config, self.baseline_m, self._of_vergence = config, baseline_m, activations

    def training(self, draw: np.random.Generator, _: Activations = ()) -> tuple[float, Activations]:
        """Draw the plane's distance in m, and activations of eyes that look at another one."""
        config = self._config
        object_distance_m, fixation_distance_m = (
            drawn_distance_m(config, draw, ends_m, self.baseline_m)
            for ends_m in (config.object_distance_m, config.fixation_distance_m)
        )
        vergence_deg = desired_vergence_deg(fixation_distance_m, self.baseline_m)
        return object_distance_m, self._activations(vergence_deg, draw)

    def trial(self, condition: Condition, draw: np.random.Generator) -> Activations:
        """Return activations with the condition's error."""
        desired_deg = desired_vergence_deg(condition.object_distance_m, self.baseline_m)
        return self._activations(desired_deg - condition.start_error_deg, draw)

    def _activations(self, vergence_deg: float, draw: np.random.Generator) -> Activations:
        return self._of_vergence(vergence_deg, float(draw.random()))

    def targets_deg(self, *_: object) -> tuple[float, ...]:
        """Return none, since saccades turn each eye about all axes."""
        return ()


class JointStarts(PairStarts):
    """Vergences of a robot's head, which looks elsewhere than straight ahead if it has a neck."""

    argument = "joints_rad"

    def __init__(self, config: ProtocolConfig, baseline_m: float) -> None:
        """Nothing else is known of a head."""
        self._config, self.baseline_m = config, baseline_m

    def _activations(self, vergence_deg: float, draw: np.random.Generator) -> Activations:
        """Return the angles of the joints in rad, in the order of the command space."""
        pan_deg, tilt_deg = draw.uniform(-1.0, 1.0, 2) * self._config.start_version_deg
        angles_deg = {"pan": pan_deg, "tilt": tilt_deg, "vergence": vergence_deg}
        return tuple(math.radians(angles_deg[name]) for name in self._config.space.names)


class GazeStarts:
    """Errors about all axes that the commands turn, and version, drawn from ranges."""

    argument = "activations"

    def __init__(
        self,
        config: ProtocolConfig,
        mechanics: MechanicsConfig,
        turns_deg: TurnsDeg = NO_TURNS_DEG,
    ) -> None:
        """Build an inverse of the eyes; turns_deg: of the cameras in them."""
        self._config, self.baseline_m = config, mechanics.baseline_m
        self._inverse = gaze_inverse(config, mechanics, turns_deg)

    def training(
        self, draw: np.random.Generator, left: Activations = ()
    ) -> tuple[float, Activations]:
        """Draw the plane's distance in m, and activations: with a gaze, or near the tonic level.

        left: those of the commanded muscles that the last episode left, none before the first.
        """
        config = self._config
        ends_m = config.object_distance_m
        distance_m = drawn_distance_m(config, draw, ends_m, self.baseline_m)
        if config.tonic_return:
            return distance_m, tuple(self._inverse.returned(left, config.tonic_return).tolist())
        if config.tonic_start_spread or any(config.tonic_common_spread):
            aside = self._aside(config.tonic_start_spread, draw)
            common = config.tonic_common_spread[: len(aside) // len(SIDES)]
            aside += np.tile(draw.normal(0.0, common), len(SIDES))
            return distance_m, tuple(self._inverse.near_tonic(aside).tolist())
        return distance_m, self._activations(draw_angles_deg(config, draw), distance_m, draw)

    def trial(self, condition: Condition, _: np.random.Generator) -> Activations:
        """Return activations with the condition's gaze, or at rest with tonic_return."""
        if self._config.tonic_return:
            return tuple(self._inverse.returned((), 1.0).tolist())
        draw = _draw_of(self._config, condition.start)
        angles_deg = draw_angles_deg(self._config, draw, of_tests=True)
        return self._activations(angles_deg, condition.object_distance_m, draw)

    def _activations(
        self, angles_deg: dict[str, float], distance_m: float, draw: np.random.Generator
    ) -> Activations:
        aside = self._aside(self._config.start_spread, draw)
        return tuple(self._inverse.activations(angles_deg, distance_m, aside).tolist())

    def _aside(self, spread: float, draw: np.random.Generator) -> np.ndarray:
        return draw.normal(0.0, spread, len(self._config.space.turning.names))

    def targets_deg(
        self, activations: Activations, n_iterations: int, draw: np.random.Generator
    ) -> tuple[float, ...]:
        """Draw the targets of an episode that begins with activations (12,); see drawn_targets_deg.

        None for eyes that make no saccades.
        """
        if not self._config.fixation_iterations:
            return ()
        gaze_deg = self._inverse.left_gaze_deg(np.array(activations))
        return drawn_targets_deg(self._config, n_iterations, gaze_deg, draw)


class LensStarts:
    """Starts of eyes with lenses, whose activations come after those that turn the eyes.

    Each lens begins anywhere within the limits of its command, which tells nothing of the object;
    pupils begin at rest.
    """

    argument = "activations"

    def __init__(
        self, turned: PairStarts | GazeStarts, config: ProtocolConfig, resting: np.ndarray
    ) -> None:
        """turned: how the eyes begin; resting: (4,) activations of lenses and pupils at rest."""
        self._turned, self._resting, self.baseline_m = turned, resting, turned.baseline_m
        n = len(config.space.turning.names)
        self._ends = config.limits.lowest[n:], config.limits.highest[n:]

    def training(
        self, draw: np.random.Generator, left: Activations = ()
    ) -> tuple[float, Activations]:
        """Draw the plane's distance in m, and activations (16,)."""
        distance_m, activations = self._turned.training(draw, left)
        return distance_m, activations + self._lenses(draw)

    def trial(self, condition: Condition, draw: np.random.Generator) -> Activations:
        """Return activations with the condition's gaze, and draw those of lenses."""
        return self._turned.trial(condition, draw) + self._lenses(draw)

    def _lenses(self, draw: np.random.Generator) -> Activations:
        activations = self._resting.copy()
        activations[::2] = draw.uniform(*self._ends)
        return tuple(activations.tolist())

    def targets_deg(self, *_: object) -> tuple[float, ...]:
        """Return none: eyes with lenses make no saccades."""
        return ()


# The first activations or angles of episodes, for a plant as it is in one stage of a run.
Starts = PairStarts | GazeStarts | LensStarts


def starts(
    config: ProtocolConfig,
    mechanics: MechanicsConfig,
    turns_deg: TurnsDeg = NO_TURNS_DEG,
    lenses: LensesConfig = _LENSES,
) -> Starts:
    """Return how episodes begin with eyes of these mechanics; turns_deg: of the cameras in them.

    The pair's errors are those of the eyes themselves. lenses: of eyes that have them.
    """
    if config.space.of_joints:
        return JointStarts(config, mechanics.baseline_m)
    turned = _turned_starts(config, mechanics, turns_deg)
    if not config.space.has_lenses:
        return turned
    return LensStarts(turned, config, Lenses(lenses).resting_activations)


def _turned_starts(
    config: ProtocolConfig, mechanics: MechanicsConfig, turns_deg: TurnsDeg
) -> PairStarts | GazeStarts:
    if config.turning_space == PAIR:
        inverse, limits = Inverse(mechanics), config.pair_limits
        of_vergence = functools.partial(inverse.activations, limits=limits)
        return PairStarts(config, mechanics.baseline_m, of_vergence)
    return GazeStarts(config, mechanics, turns_deg)


def gaze_inverse(
    config: ProtocolConfig, mechanics: MechanicsConfig, turns_deg: TurnsDeg = NO_TURNS_DEG
) -> GazeInverse:
    """Return what finds activations for a gaze, within the limits of first activations."""
    limits = config.turning_limits
    return GazeInverse(mechanics, config.space.turning, limits.lowest, limits.highest, turns_deg)


def draw_angles_deg(
    config: ProtocolConfig, draw: np.random.Generator, *, of_tests: bool = False
) -> dict[str, float]:
    """Draw a gaze, by names of GAZE_ANGLES that the command space turns.

    Errors lie anywhere within their ranges, or in the corner where the run's training begins more
    often (of_tests: its tests); version and elevation anywhere.
    """
    largest_deg, sides = largest_angles_deg(config), corner(config, of_tests=of_tests)
    shares = draw.uniform(-1.0, 1.0, len(largest_deg))
    if config.aside_share:
        in_corner = draw.uniform(*_CORNER, len(ERRORS)) * sides
        if draw.random() < config.aside_share:
            n = sum(name in ERRORS for name in largest_deg)
            shares[:n] = in_corner[:n]
    return {
        name: float(most * share)
        for (name, most), share in zip(largest_deg.items(), shares, strict=True)
    }


def corner(config: ProtocolConfig, *, of_tests: bool = False) -> np.ndarray:
    """Return the signs (3,) of ERRORS in the corner of the ranges where more episodes begin."""
    sides = generator(config.seed, "corner of starts", 0).choice((-1.0, 1.0), len(ERRORS))
    return -sides if of_tests else sides


def largest_angles_deg(config: ProtocolConfig) -> dict[str, float]:
    """Return the largest errors and version with which episodes begin, by names of GAZE_ANGLES."""
    largest = dict(zip(ERRORS, config.start_error_deg, strict=True)) | dict(
        zip(("version", "elevation"), config.start_version_deg, strict=True)
    )
    return {name: largest[name] for name in TURNED_ANGLES[config.turning_space]}


def _draw_of(config: ProtocolConfig, start: int) -> np.random.Generator:
    return generator(config.seed, "start of trial", start)


def drawn_targets_deg(
    config: ProtocolConfig,
    n_iterations: int,
    gaze_deg: tuple[float, float],
    draw: np.random.Generator,
) -> tuple[float, ...]:
    """Draw azimuth and elevation of the target of each fixation, one after the other.

    gaze_deg: those of the left eye at the start. Each target lies at a drawn distance from the one
    before, in a direction that is drawn until it is within range; a gaze so far aside that none is
    comes back to the nearest place within range.
    """
    targets_deg: list[float] = []
    least_deg, most_deg = config.target_distance_deg
    place, most = np.array(gaze_deg), np.array(config.largest_target_deg)
    for _ in range(n_iterations // config.fixation_iterations):
        for _ in range(_MOST_DRAWS):
            away = draw.uniform(least_deg, most_deg)
            direction = draw.uniform(0.0, 2.0 * np.pi)
            target = place + away * np.array([np.cos(direction), np.sin(direction)])
            if (np.abs(target) <= most).all():
                break
        place = np.clip(target, -most, most)
        targets_deg += place.tolist()
    return tuple(targets_deg)


def drawn_distance_m(
    config: ProtocolConfig,
    draw: np.random.Generator,
    ends_m: tuple[float, ...],
    baseline_m: float,
) -> float:
    """Draw a distance uniformly (K17), or one of uniformly drawn vergence (D18).

    ends_m: (2,) nearest and farthest.
    ours: uniform distances are seldom near, so that the vergence errors of more than 2 deg with
    which a test may start hardly occur in training.
    """
    nearest_m, farthest_m = ends_m
    if not config.draws_vergence_evenly:
        return float(draw.uniform(nearest_m, farthest_m))
    vergence = draw.uniform(
        desired_vergence_deg(farthest_m, baseline_m),
        desired_vergence_deg(nearest_m, baseline_m),
    )
    return distance_of_vergence_m(float(vergence), baseline_m)
