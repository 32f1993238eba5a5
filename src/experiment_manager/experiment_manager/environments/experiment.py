"""What an environment is made of: a plant, coders of any seed, and the protocol's episodes."""

import dataclasses
import operator
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import Protocol, make_protocol
from experiment_manager.preparation.configuration import configuration_of
from experiment_manager.preparation.request import RunRequest
from eye_plant.camera.config import CameraConfig
from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.plant import EyePlant
from lockstep.command_space import CommandSpace
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.state_file import read_state
from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from vergence_rl.config import VergenceRlConfig


@dataclass(frozen=True)
class _Settings:
    manager: ExperimentManagerConfig
    plant: EyePlantConfig
    coder: SparseCoderConfig
    agent: VergenceRlConfig


class Experiment:
    """The episodes of any seed, before one plant."""

    def __init__(self, settings: _Settings, coder_state: Mapping[str, np.ndarray] | None) -> None:
        """coder_state: what every coder starts from, in place of random dictionaries."""
        self._settings = settings
        self._coder_state = coder_state
        self.camera: CameraConfig = settings.plant.camera
        self.n_bases = settings.coder.n_bases
        # The squares of what matching pursuit takes from a patch sum up to the patch's, 1 for each
        # eye; one atom takes most where all selections are of it, and alike.
        self.largest_feature = 2.0 * settings.coder.n_selections
        self.plant = EyePlant(settings.plant)
        self._protocol: Protocol = make_protocol(settings.manager)
        self._n_training = self._protocol.segments[-1].first

    @property
    def activation_limits(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest activations, (n_muscles,) each."""
        return self._settings.agent.limits

    @property
    def space(self) -> CommandSpace:
        """What an action moves."""
        return self._settings.agent.space

    @property
    def has_targets(self) -> bool:
        """Whether episodes have gaze targets."""
        return self._settings.manager.protocol.fixation_iterations > 0

    def start(self, seed: int) -> SparseCoder:
        """Begin the experiment of a seed; return its coder."""
        coder = SparseCoder(dataclasses.replace(self._settings.coder, seed=seed))
        if self._coder_state is not None:
            coder.restore(self._coder_state)
        self._protocol = make_protocol(dataclasses.replace(self._settings.manager, seed=seed))
        return coder

    def training_episode(self, number: int) -> Episode:
        """Return a training episode; raises InputError when the experiment has no such."""
        return self._episode("episode", number, 0, self._n_training)

    def after(self, number: int) -> int:
        """Return the number of the training episode that follows."""
        return (number + 1) % self._n_training

    def trial(self, number: int) -> Episode:
        """Return a trial of the test; raises InputError when the test has no such."""
        return self._episode("trial", number, self._n_training, self._protocol.n_trials)

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


def make_experiment(request: RunRequest, coder_state: str | Path | None) -> Experiment:
    """Return the experiment that is asked for, without tests during training.

    coder_state: see `VergenceEnvironment`.
    """
    configuration = configuration_of(request, commit="")
    manager = build(ExperimentManagerConfig, configuration["experiment_manager"])
    end = (manager.protocol.n_training_iterations,)
    protocol = dataclasses.replace(manager.protocol, test_iterations=end)
    coder = build(SparseCoderConfig, configuration["sparse_coder"])
    state = None
    if coder_state is not None:
        state = read_state(Path(coder_state), "sparse_coder")
        SparseCoder(coder).restore(state)  # refuses here what would be refused at each reset
    return Experiment(
        _Settings(
            dataclasses.replace(manager, protocol=protocol),
            build(EyePlantConfig, configuration["eye_plant"]),
            coder,
            build(VergenceRlConfig, configuration["vergence_rl"]),
        ),
        state,
    )
