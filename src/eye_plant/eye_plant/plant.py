"""The whole plant: two eyes, their muscles, and what they see. The order of its step is here."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from eye_plant.commands import target_activations
from eye_plant.config import EyePlantConfig, changed
from eye_plant.episode import Episode
from eye_plant.gaze_error import gaze_error, listing_torsion_deg, target_places_deg
from eye_plant.ground_truth import GroundTruth
from eye_plant.lens.lenses import Lenses, LensState, checked
from eye_plant.mechanics.mujoco_model import N_MUSCLES
from eye_plant.mechanics.oculomotor import Oculomotor, OculomotorState
from eye_plant.observation import Observation, with_lenses
from eye_plant.senses import Senses
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stimulus_set import StimulusSet, load_stimuli
from eye_plant.turns import turned
from eye_plant.vergence import desired_vergence_deg
from lockstep import PAIR, InputError
from lockstep.wire.topics import TRAINING

_AHEAD_DEG: tuple[float, ...] = (0.0,) * 4


class EyePlant:
    """Runs one episode after another: `begin`, then `execute` once per command.

    An episode starts from nothing: `begin` settles the eyes at its first activations whatever came
    before, so the same episode and commands give the same observations.

    Example:
        >>> import numpy as np
        >>> from eye_plant import Episode, EyePlant, EyePlantConfig, Inverse, StimulusSet
        >>> noise = np.random.default_rng(0).integers(0, 256, (2, 64, 64), np.uint8)
        >>> config = EyePlantConfig()
        >>> plant = EyePlant(config, StimulusSet((noise[0],), (noise[1],)))
        >>> limits = (0.0, 0.2), (0.0, 0.1)  # of medial and lateral rectus
        >>> start = Inverse(config.mechanics).activations(3.0, 0.5, limits)
        >>> seen = plant.begin(Episode.alone(0, 1.0, start, n_iterations=1))
        >>> seen.pictures.shape, round(seen.truth.vergence_deg, 3)
        ((2, 240, 320), 3.0)
        >>> command = plant.targets(["medial_rectus", "lateral_rectus"], np.array([0.1, 0.0]))
        >>> seen = plant.execute(command)
        >>> seen.truth.vergence_deg > 3.0
        True
        >>> plant.close()
    """

    def __init__(self, config: EyePlantConfig, stimuli: StimulusSet | None = None) -> None:
        """Set up mechanics and camera; raises InputError when they cannot.

        stimuli: instead of those that the configuration asks for.
        """
        if config.space.of_joints:
            raise InputError(
                f"command_space: expected one of muscles, got {config.command_space}, of the joints"
                " of a robot's head, which takes the place of eye_plant (docs/how_to/own_head.md)"
            )
        self._started_with = self.config = config
        self._settings: Mapping[str, Any] = {}
        self.oculomotor = Oculomotor(config.mechanics)
        self._cost = config.cost_of_vergence
        self._lenses = Lenses(config.lenses) if config.space.has_lenses else None
        self._camera = StereoCamera(
            config.worn_camera,
            load_stimuli(config.stimuli) if stimuli is None else stimuli,
            config.mechanics.eye_height_m,
            config.scales,
            focuses=config.space.has_lenses,
        )
        self.n_stimuli = self._camera.n_stimuli
        self._senses = Senses(config.noise, config.camera, config.seed)
        self._held_activations = with_lenses(self.oculomotor.tonic_activations, self._lens_state)
        self._episode: Episode | None = None
        self._iteration = 0
        self._desired_deg = 0.0
        self._initial_rate_w = 0.0
        # Of each gaze target, None where there is none.
        self._optimal_rates_w: Mapping[tuple[float, float] | None, float] = {}

    @property
    def is_waiting(self) -> bool:
        """Whether an episode is under way, so that `execute` is allowed."""
        episode = self._episode
        return episode is not None and self._iteration < episode.n_iterations

    def reconfigure(self, settings: Mapping[str, Any]) -> None:
        """Apply these settings to the first configuration, from the next episode on.

        settings: by dotted name, of eye_plant.config.changeable_parameters; {} takes back all
        changes. Nothing is done where nothing changes. Raises InputError, having changed nothing,
        for settings that the plant cannot have.
        """
        if settings == self._settings:
            return
        config = changed(self._started_with, settings)
        if config == self.config:
            self._settings = dict(settings)
            return
        oculomotor, cost = self.oculomotor, self._cost
        if config.mechanics != self.config.mechanics:
            oculomotor = Oculomotor(config.mechanics)
        if config.least_costs_of != self.config.least_costs_of:
            cost = config.cost_of_vergence
        lenses = Lenses(config.lenses) if config.space.has_lenses else None
        if config.worn_camera != self.config.worn_camera:
            self._camera.reconfigure(config.worn_camera)
        # Nothing is refused from here on.
        self.oculomotor, self._cost, self._lenses = oculomotor, cost, lenses
        self.config, self._settings = config, dict(settings)
        self._senses = Senses(config.noise, config.camera, self._senses.seed)
        self._episode = None

    def reseed(self, seed: int) -> None:
        """Draw the noise of the episodes to come from another seed than the configuration's."""
        self._senses.seed = seed

    def begin(self, episode: Episode) -> Observation:
        """Start an episode and return its observation 0.

        Raises InputError, having changed nothing, for the start of a robot's head, an unknown
        stimulus, and a distance that the camera does not draw or at which the muscles cannot
        converge.
        """
        if episode.joints_rad:
            raise InputError(f"joints_rad: expected activations, got {list(episode.joints_rad)}")
        self._camera.check(episode.stimulus, episode.object_distance_m)
        desired_deg = desired_vergence_deg(
            episode.object_distance_m,
            self.config.mechanics.baseline_m,
            self._camera.parallax_m(episode.stimulus),
        )
        optimal_rates_w = self._least_rates_w(episode, desired_deg)
        activations = self._first_activations(episode)
        # Nothing is refused from here on.
        self._episode, self._iteration = episode, 0
        self._desired_deg, self._optimal_rates_w = desired_deg, optimal_rates_w
        self._held_activations = activations
        self._senses.begin()
        self.oculomotor.settle(activations[:N_MUSCLES])
        if self._lenses:
            self._lenses.settle(activations[N_MUSCLES:])
        state = self.oculomotor.state()
        self._initial_rate_w = self._charged_rate_w(state)
        return self._observe(episode, state)

    def targets(self, names: Sequence[str], values: np.ndarray) -> np.ndarray:
        """Return the target activations of a command; see `target_activations`.

        Muscles that it does not name keep their last target, at first the first activation of the
        episode. In lockstep a command of muscles with commands of their own names all of
        them; raises InputError for another one.
        """
        space = self.config.space
        is_own = self.config.turning_space != PAIR and not self.config.free_running.rate_hz
        if is_own and set(names) != set(space.names):
            raise InputError(
                f"muscle_command: expected {', '.join(space.names)}, as command_space "
                f"{self.config.command_space} has, got {', '.join(names)}"
            )
        return target_activations(names, values, self._held_activations)

    def execute(self, activations: np.ndarray) -> Observation:
        """Move the eyes for one control period towards the target activations in [0, 1].

        activations: (12,), of eyes with lenses (16,); lenses and pupils, too, end settled.
        Raises InputError, having changed nothing, when no command is expected or an activation is
        out of range.
        """
        return self._move(self.oculomotor.step, activations, math.inf)

    def advance(self, activations: np.ndarray, duration_s: float) -> Observation:
        """Simulate for a while towards the target activations, without settling; like `execute`."""
        move = partial(self.oculomotor.advance, duration_s=duration_s)
        return self._move(move, activations, duration_s)

    def _move(
        self, move: Callable[[np.ndarray], None], activations: np.ndarray, duration_s: float
    ) -> Observation:
        episode = self._episode
        if episode is None or not self.is_waiting:
            raise InputError("expected a command during an episode only, got one outside")
        if self._lenses:
            of_lenses = checked(activations[N_MUSCLES:])
            move(activations[:N_MUSCLES])
            self._lenses.advance(of_lenses, duration_s)
        else:
            move(activations)
        self._held_activations = activations
        self._iteration += 1
        return self._observe(episode, self.oculomotor.state())

    def _observe(self, episode: Episode, state: OculomotorState) -> Observation:
        adduction_deg, elevation_deg, _ = np.degrees(state.eye_angles_rad).T.tolist()
        positions_m, rotations = self.oculomotor.eye_positions_m(), self.oculomotor.eye_rotations()
        is_pair = self.config.turning_space == PAIR
        # Eyes that one command turns alike have K17's errors, which are the eyes' own.
        seeing = rotations if is_pair else turned(rotations, self.config.camera.turns_deg)
        error = gaze_error(
            positions_m,
            seeing,
            episode.object_distance_m,
            self._camera.parallax_m(episode.stimulus),
        )
        # Those look straight ahead, where K17's formula holds.
        desired_deg = self._desired_deg if is_pair else sum(adduction_deg) + error.horizontal_deg
        target_deg = episode.target_deg(self._iteration)
        places_deg = _AHEAD_DEG
        if target_deg is not None:
            places_deg = target_places_deg(
                positions_m, seeing, target_deg, episode.object_distance_m
            )
        truth = GroundTruth(
            adduction_deg=tuple(adduction_deg),
            elevation_deg=tuple(elevation_deg),
            torsion_deg=listing_torsion_deg(rotations),
            gaze_error=error,
            desired_vergence_deg=desired_deg,
            metabolic_rate_w=self._charged_rate_w(state),
            initial_metabolic_rate_w=self._initial_rate_w,
            optimal_metabolic_rate_w=self._optimal_rates_w[target_deg],
            target_places_deg=places_deg,
        )
        pictures, apart = None, tuple[np.ndarray, ...]()
        lenses, moment = self._lens_state, episode.moment(self._iteration)
        if self.is_waiting:  # the last observation has none
            view = positions_m, rotations, episode.stimulus, episode.object_distance_m
            pictures = self._senses.pictures(self._camera.render(*view, lenses), moment)
            apart = tuple(
                self._senses.pictures(drawn, moment, scale.name)
                for scale, drawn in self._camera.render_apart(*view, lenses)
            )
        felt = self._senses.felt(with_lenses(state.activations, lenses), moment)
        return Observation(episode, self._iteration, pictures, state, truth, felt, lenses, apart)

    @property
    def _lens_state(self) -> LensState | None:
        return self._lenses.state() if self._lenses else None

    def _first_activations(self, episode: Episode) -> np.ndarray:
        """Return those that an episode begins with, (12,) or (16,); raises InputError."""
        activations = np.array(episode.activations)
        if self._lenses is None and len(activations) > N_MUSCLES:
            raise InputError(
                f"activations: expected {N_MUSCLES} of eyes without lenses, got {len(activations)}"
            )
        if self._lenses and len(activations) == N_MUSCLES:
            return np.append(activations, self._lenses.resting_activations)
        return activations

    def _least_rates_w(
        self, episode: Episode, desired_deg: float
    ) -> dict[tuple[float, float] | None, float]:
        """Return C* for each target of an episode, or for None."""
        if not episode.n_targets:
            return {None: self._cost.least_w(desired_deg)}
        targets = set(zip(episode.targets_deg[::2], episode.targets_deg[1::2], strict=True))
        if episode.phase == TRAINING:
            # Others may come by the topic gaze_target, and tests alone compare with C*.
            return dict.fromkeys(targets, math.nan)
        return {target: self._cost.least_w(desired_deg, target) for target in targets}

    def _charged_rate_w(self, state: OculomotorState) -> float:
        return float(state.metabolic_rate_w[self.config.space.turning.indices].sum())

    def close(self) -> None:
        """Release what the camera holds."""
        self._camera.close()
