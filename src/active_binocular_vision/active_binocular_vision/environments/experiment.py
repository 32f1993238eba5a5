"""What an environment is made of: a plant, coders of any seed, and the protocol's episodes."""

import dataclasses
import operator
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager import ExperimentManagerConfig, RunRequest, configuration_of, make_protocol
from experiment_manager.sections import config_of
from eye_plant import Episode, EyePlant, EyePlantConfig
from eye_plant.stimuli.stimulus_set import announcement
from lockstep import InputError, read_state
from sparse_coder import SparseCoder, SparseCoderConfig
from vergence_rl import VergenceRlConfig


class Experiment:
    """The episodes of any seed, before one plant, without tests during training.

    activation_limits: lowest and highest, (n_muscles,) each; space: what an action moves;
    has_targets: whether episodes have gaze targets.
    """

    def __init__(self, request: RunRequest, coder_state: str | Path | None) -> None:
        """coder_state: see `VergenceEnvironment`; every coder starts from it."""
        configuration = configuration_of(request, commit="")
        manager = config_of(ExperimentManagerConfig, configuration)
        end = (manager.n_training_iterations,)
        self._manager = dataclasses.replace(manager, test_iterations=end)
        self._coder = config_of(SparseCoderConfig, configuration)
        self._coder_state: Mapping[str, np.ndarray] | None = None
        if coder_state is not None:
            self._coder_state = read_state(Path(coder_state), "sparse_coder")
        self.start(manager.seed)  # refuses here what would be refused at each reset
        self._n_training = self._protocol.segments[-1].first
        plant = config_of(EyePlantConfig, configuration)
        agent = config_of(VergenceRlConfig, configuration)
        self.camera = plant.camera
        self.n_bases = self._coder.n_bases
        # The squares of what matching pursuit takes from a patch sum up to the patch's, 1 for each
        # eye; one atom takes most where all selections are of it, and alike.
        self.largest_feature = 2.0 * self._coder.n_selections
        self.activation_limits = agent.limit_arrays
        self.space = agent.space
        self.has_targets = manager.fixation_iterations > 0
        if text := announcement(plant.stimuli):
            print(text, file=sys.stderr, flush=True)
        self.plant = EyePlant(plant)

    def start(self, seed: int) -> SparseCoder:
        """Begin the experiment of a seed; return its coder."""
        coder = SparseCoder(dataclasses.replace(self._coder, seed=seed))
        if self._coder_state is not None:
            coder.restore(self._coder_state)
        self._protocol = make_protocol(dataclasses.replace(self._manager, seed=seed))
        return coder

    def training_episode(self, number: int) -> Episode:
        """Return a training episode; raises InputError for a number beyond the last."""
        return self._episode("episode", number, 0, self._n_training)

    def after(self, number: int) -> int:
        """Return the number of the training episode that follows."""
        return (number + 1) % self._n_training

    def trial(self, number: int) -> Episode:
        """Return a trial of the test; raises InputError for a number beyond the last."""
        return self._episode("trial", number, self._n_training, self._protocol.n_trials)

    def plant_settings(self, episode: Episode) -> dict[str, Any]:
        """Return the plant's parameters that the schedule has changed by an episode."""
        return self._protocol.plant_settings(episode)

    def _episode(self, name: str, number: int, first: int, count: int) -> Episode:
        expected = f"{name}: expected a whole number from 0 to {count - 1}, got {number!r}"
        try:
            number = operator.index(number)  # of NumPy, too
        except TypeError as error:
            raise InputError(expected) from error
        if not 0 <= number < count:
            raise InputError(expected)
        episode = self._protocol.episode(first + number)
        # In the graph the last observation has no pictures; an agent here is owed them.
        return dataclasses.replace(episode, n_iterations=episode.n_iterations + 1)
