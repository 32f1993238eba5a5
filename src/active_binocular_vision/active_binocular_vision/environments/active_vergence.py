"""Plant and sparse coder as an environment; whoever acts is the third part.

Dimensions: n_muscles is the number of commands, of the pair 2, medial and lateral rectus, the same
for both eyes.
"""

import copy
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box, Dict, Space

from active_binocular_vision.environments.experiment import Experiment
from active_binocular_vision.environments.one_thread import OneThread
from experiment_manager import RunRequest
from experiment_manager.anaglyph import anaglyph
from eye_plant import Episode, Observation
from lockstep import InputError
from lockstep.wire.topics import GROUND_TRUTH_NAMES, TRAINING
from sparse_coder import Percept, SparseCoder

Pictures = np.ndarray
_RESET_OPTIONS = ("episode", "trial")
_LARGEST_SEED = 2**31
one_thread = OneThread()


class VergenceEnvironment(gymnasium.Env[Any, np.ndarray]):
    """One episode of K17 after another: ten steps, then truncated; nothing terminates.

    Action (n_muscles,) in [-1, 1]: change of activation, in units of `action_scale`. By default
    that is the least power of two that spans a muscle's limits, so that any activation is one step
    away, and that scaling rounds nothing. Activations are kept within the limits, as the agent's.
    They change from what is felt, where noise (`eyes.noise`) makes that differ from what is.
    Reward: -E - lambda C of the observation that the action led to (K17 eq. 5).
    info: "ground_truth", by the names of that topic that have a value, from which no agent should
    learn, since no eye can see it; reconstruction_error_coarse, _fine; "reward" of what is
    observed, also at the start.

    The coder learns from each observation of a training episode but the last, which in the graph
    is not drawn. `reset(seed=)` starts the experiment of that seed from nothing, the coder too.
    `reset(options={"episode": n})` gives training episode n, `{"trial": n}` trial n of the test,
    in which the coder does not learn; without, the next training episode comes, after the last
    one (number 99,999 by default) the first again.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 (Gymnasium's)

    def __init__(
        self,
        *,
        profile: str = "paper",
        model: str | None = None,
        settings: Mapping[str, Any] | None = None,
        coder_state: str | Path | None = None,
        coder_learns: bool = True,
        action_scale: float | None = None,
        render_mode: str | None = None,
    ) -> None:
        """Set up plant and coder.

        profile: by name, as --profile of abv run; model: M, or M_C, which counts
        energy, None for the profile's; settings: {"SECTION.NAME": value}, as its --set;
        coder_state: sparse_coder.npz of a checkpoint, to begin with; action_scale: change of either
        activation that an action of 1 makes.
        Raises InputError for whatever abv run would refuse.
        """
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise InputError(f"render_mode: expected None or rgb_array, got {render_mode!r}")
        if action_scale is not None and not 0.0 < action_scale <= 1.0:
            raise InputError(f"action_scale: expected more than 0, at most 1, got {action_scale}")
        self.render_mode = render_mode
        self._experiment = Experiment(
            RunRequest(
                profile=profile,
                model=model,
                overrides=settings or {},
                names={key: f"settings[{key!r}]" for key in settings or {}},
            ),
            coder_state,
        )
        self._coder_learns = coder_learns
        self._plant = self._experiment.plant
        self._space = self._experiment.space
        self._lowest, self._highest = self._experiment.activation_limits
        whole = 2.0 ** np.ceil(np.log2(self._highest - self._lowest))
        self.action_scale = whole if action_scale is None else np.full_like(whole, action_scale)
        self.action_space = Box(-1.0, 1.0, (len(self._space.names),), np.float64)
        self.observation_space = Dict(self._all_senses())
        self._coder: SparseCoder | None = None
        self._episode: Episode | None = None
        self._is_closed = False
        self._next_episode = 0
        self._pictures: Pictures | None = None
        self._activations = np.full(len(self._space.names), math.nan)

    def __copy__(self) -> "VergenceEnvironment":
        """Copy in depth: eyes that two environments share would move in both."""
        return copy.deepcopy(self)

    def _all_senses(self) -> dict[str, Space[Any]]:
        lowest, highest = self._lowest, self._highest
        if self._plant.config.noise.is_of_activations:
            lowest, highest = np.zeros_like(lowest), np.ones_like(highest)
        activations = Box(lowest, highest, dtype=np.float64)
        senses: dict[str, Space[Any]] = {**self._senses(), "activations": activations}
        if self._experiment.has_targets:
            senses["gaze_target"] = Box(-180.0, 180.0, (2,), np.float64)
        return senses

    def _senses(self) -> dict[str, Box]:
        """Return the spaces of what an agent is given of the pictures."""
        raise NotImplementedError

    def _sensed(self, pictures: Pictures, percept: Percept) -> dict[str, np.ndarray]:
        """Return what an agent is given of the pictures, sharing no memory with anything."""
        raise NotImplementedError

    @one_thread
    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, np.ndarray], dict[str, Any]]:
        """Begin an episode; raises InputError for an option that is none, and once closed."""
        self._check_open("reset")
        super().reset(seed=seed)
        if seed is None and self._coder is None:
            seed = int(self.np_random.integers(_LARGEST_SEED))
        if seed is not None:
            self._coder = self._experiment.start(seed)
            self._plant.reseed(seed)
            self._next_episode = 0
        episode = self._chosen(options or {})
        self._episode = episode
        self._plant.reconfigure(self._experiment.plant_settings(episode))
        observed, _, info = self._observe(self._plant.begin(episode))
        return observed, info

    def _chosen(self, options: dict[str, Any]) -> Episode:
        unknown = sorted(set(options) - set(_RESET_OPTIONS))
        if unknown or len(options) > 1:
            raise InputError(
                f"reset options: expected one of {', '.join(_RESET_OPTIONS)} at most, got "
                f"{', '.join(unknown or options)}"
            )
        if "trial" in options:
            return self._experiment.trial(options["trial"])
        number = options.get("episode", self._next_episode)
        episode = self._experiment.training_episode(number)
        self._next_episode = self._experiment.after(number)
        return episode

    @one_thread
    def step(
        self, action: np.ndarray
    ) -> tuple[dict[str, np.ndarray], float, bool, bool, dict[str, Any]]:
        """Move the eyes for one control period; raises InputError out of an episode."""
        self._check_open("step")
        if self._episode is None:
            raise InputError("step: expected a reset before, and after the end of each episode")
        action = np.asarray(action, np.float64)
        if action.shape != self.action_space.shape or not np.isfinite(action).all():
            n_commands = len(self._space.names)
            raise InputError(f"action: expected {n_commands} finite numbers, got {action.tolist()}")
        change = self.action_scale * np.clip(action, -1.0, 1.0)
        command = np.clip(self._activations + change, self._lowest, self._highest)
        observation = self._plant.execute(self._plant.targets(self._space.names, command))
        observed, reward, info = self._observe(observation)
        truncated = self._is_last(observation)
        if truncated:
            self._episode = None
        return observed, reward, False, truncated, info

    def _check_open(self, name: str) -> None:
        if self._is_closed:
            raise InputError(f"{name}: expected it before close, got it after; make another one")

    def _is_last(self, observation: Observation) -> bool:
        # The experiment's episodes have one observation more than the graph's, with pictures.
        return observation.iteration == observation.episode.n_iterations - 1

    def _observe(
        self, observation: Observation
    ) -> tuple[dict[str, np.ndarray], float, dict[str, Any]]:
        assert self._coder is not None
        assert observation.pictures is not None
        in_training = observation.episode.phase == TRAINING
        rates_w = observation.rates_w(self._space)
        left, right = observation.pictures
        percept = self._coder.perceive(left, right, rates_w, apart=observation.apart)
        if self._coder_learns and in_training and not self._is_last(observation):
            self._coder.learn(percept.encoding)
        self._pictures = observation.pictures.copy()
        self._activations = self._space.from_all(observation.felt)
        observed = self._sensed(self._pictures, percept)
        observed["activations"] = self._activations.copy()
        if self._experiment.has_targets:
            observed["gaze_target"] = np.array(observation.truth.target_deg)
        truth = zip(GROUND_TRUTH_NAMES, observation.ground_truth_values(), strict=True)
        coarse, fine = percept.encoding.reconstruction_error
        info = {
            # Apart from the rest: wrappers of others have an "episode" of their own.
            # C* where it is not known is left out: NaN is not equal to itself.
            "ground_truth": {name: value for name, value in truth if not math.isnan(value)},
            "reconstruction_error_coarse": float(coarse),
            "reconstruction_error_fine": float(fine),
            "reward": percept.reward,
        }
        return observed, percept.reward, info

    def render(self) -> np.ndarray | None:
        """Return the anaglyph (height, width, 3) uint8 of what the eyes see now."""
        if self.render_mode is None or self._pictures is None:
            return None
        return anaglyph(*self._pictures)

    def close(self) -> None:
        """Release what the camera holds."""
        self._is_closed = True
        self._plant.close()


class PictureEnvironment(VergenceEnvironment):
    """ActiveVergence-v0: pictures (2, height_px, width_px) uint8, left then right."""

    def _senses(self) -> dict[str, Box]:
        camera = self._experiment.camera
        return {"pictures": Box(0, 255, (2, camera.roi_height_px, camera.roi_width_px), np.uint8)}

    def _sensed(self, pictures: Pictures, percept: Percept) -> dict[str, np.ndarray]:
        return {"pictures": pictures.copy()}


class FeatureEnvironment(VergenceEnvironment):
    """ActiveVergenceFeatures-v0: features (2, n_bases) float32, coarse then fine.

    Example:
        >>> import gymnasium
        >>> import active_binocular_vision.environments
        >>> settings = {"eye_plant.stimuli.directory": "photos", "eye_plant.stimuli.size_px": 64}
        >>> environment = gymnasium.make("ActiveVergenceFeatures-v0", settings=settings)
        >>> observed, info = environment.reset(seed=1)
        >>> observed["features"].shape
        (2, 400)
        >>> observed, reward, terminated, truncated, info = environment.step([0.1, 0.0])
        >>> environment.close()
    """

    def _senses(self) -> dict[str, Box]:
        shape = (2, self._experiment.n_bases)
        return {"features": Box(0.0, self._experiment.largest_feature, shape, np.float32)}

    def _sensed(self, pictures: Pictures, percept: Percept) -> dict[str, np.ndarray]:
        return {"features": percept.encoding.features.copy()}
