"""The environment that agents learn with their usual settings: one vector, a reward for each place.

Why this reward: agents discount by 0.99 per step, so the fall of E would hardly favour the shortest
way, since it adds up to the same over any. E itself differs as much between scenes as between
vergences; its excess over that of one image given to both eyes is small at correct vergence in any
scene.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from gymnasium.spaces import Box

from active_binocular_vision.environments.active_vergence import FeatureEnvironment, one_thread
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.sections import config_of
from experiment_manager.trained.directory import existing_run
from lockstep import InputError, read_state
from vergence_rl import VergenceRlConfig
from vergence_rl.normalizer import RunningStatistics, normalized

# Change of an activation by an action of 1: at most 1.25 deg of vergence, so that the noise of
# agents that explore in the whole action space stays near correct gaze, and any object is reached
# within an episode.
_ACTION_SCALE = 1.0 / 128.0
# Rewards are then between -1.5, far off, and about 0.
_REWARDS_PER_ERROR = 10.0


class VectorEnvironment(FeatureEnvironment):
    """active_binocular_vision/Vergence-v0: `FeatureEnvironment` as most agents want theirs.

    Observation (n,) float32: square roots of the features, then activations, each normalised with
    the mean and the standard deviation that it had while the eyes were trained. Reward: -10 times
    by how much E exceeds that of the left image given to both eyes. The dictionaries are those of
    trained eyes, and do not learn: an observation means the same from the first step to the last.

    Example:
        >>> import gymnasium
        >>> import active_binocular_vision.environments
        >>> settings = {"eye_plant.stimuli.directory": "photos", "eye_plant.stimuli.size_px": 64}
        >>> name = "active_binocular_vision/Vergence-v0"
        >>> environment = gymnasium.make(name, eyes="runs/first", settings=settings)
        >>> observed, info = environment.reset(seed=1)
        >>> observed.shape
        (66,)
        >>> environment.close()
    """

    def __init__(
        self,
        *,
        eyes: str | Path = "demonstration",
        settings: Mapping[str, Any] | None = None,
        action_scale: float = _ACTION_SCALE,
        render_mode: str | None = None,
    ) -> None:
        """Set up the eyes of a run, which are healthy and learn nothing.

        eyes: a run directory, or the name of trained eyes; settings, action_scale, render_mode: as
        of `VergenceEnvironment`. Raises InputError as that does, and for a run without checkpoint.
        """
        run = existing_run(eyes)
        found = checkpoint.newest(run / "checkpoints")
        if found is None:
            raise InputError(
                "eyes: expected a run with a checkpoint, or a name that abv trained lists, got "
                f"{eyes}"
            )
        configuration = read_configuration(run / CONFIG_FILE)
        agent = config_of(VergenceRlConfig, configuration)
        state = read_state(found[1] / "vergence_rl.npz", "vergence_rl")
        used = np.r_[: agent.n_features, -agent.n_muscles : 0]
        self._statistics = RunningStatistics(
            int(state["statistics_count"]),
            state["statistics_mean"][used],
            state["statistics_squared_deviation"][used],
        )
        super().__init__(
            profile=configuration["experiment_manager"]["profile"] or "paper",
            model="M",
            settings={"task.n_bases": agent.n_bases, **(settings or {})},
            coder_state=found[1] / "sparse_coder.npz",
            coder_learns=False,
            action_scale=action_scale,
            render_mode=render_mode,
        )
        self.observation_space = Box(-np.inf, np.inf, (len(used),), np.float32)

    def reset(  # type: ignore[override]
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Begin an episode, as `VergenceEnvironment` does."""
        observed, info = super().reset(seed=seed, options=options)
        return self._observed(observed, info)

    def step(  # type: ignore[override]
        self, action: np.ndarray
    ) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Move the eyes for one control period, as `VergenceEnvironment` does."""
        observed, _, terminated, truncated, info = super().step(action)
        vector, info = self._observed(observed, info)
        return vector, info["reward"], terminated, truncated, info

    def _observed(
        self, observed: Mapping[str, np.ndarray], info: dict[str, Any]
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Return the vector, and info with the reward of what is observed."""
        error = info["reconstruction_error_coarse"] + info["reconstruction_error_fine"]
        reward = -_REWARDS_PER_ERROR * (error - self._error_of_one_image())
        vector = self.vector(observed["features"], observed["activations"])
        return vector, info | {"reward": reward}

    def vector(self, features: np.ndarray, activations: np.ndarray) -> np.ndarray:
        """Return the observation of features (2, n_bases) and activations (n_muscles,)."""
        roots = np.sqrt(np.ravel(features).astype(np.float64))
        entries = np.concatenate((roots, activations))
        return normalized(self._statistics, entries, 1.0).astype(np.float32)

    @one_thread
    def _error_of_one_image(self) -> float:
        """Return E of both scales (K17 eq. 2) were the right eye's image the left one's."""
        assert self._coder is not None
        assert self._pictures is not None
        left, _ = self._pictures
        return float(self._coder.encode(left, left).reconstruction_error.sum())
