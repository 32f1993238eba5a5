"""The learners of a checkpoint, with the eyes they had then or with others."""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.learners.basis_functions import Tuning, tunings
from experiment_manager import ExperimentManagerConfig, InProcessLoop, make_loop, protocol_of
from experiment_manager.plant_changes import read_schedule
from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.sections import Configuration, config_of
from experiment_manager.trained.directory import existing_run
from eye_plant import EyePlantConfig, StimulusSet
from eye_plant.config import changed
from lockstep import InputError, flatten, read_state
from lockstep.wire.topics import TEST
from sparse_coder import SparseCoder, SparseCoderConfig

_LEARNERS = ("sparse_coder", "vergence_rl")


@dataclass(frozen=True)
class FrozenLearners:
    """Which learners, with which eyes.

    run: directory with config.yaml and checkpoints/, the bag is not needed, or the name of trained
    eyes; n_episodes: done at the checkpoint, None is the newest; dictionary, actor: directories of
    checkpoints, of this run or another, whose dictionary or whose actor, with its critic, takes the
    place of the checkpoint's own; settings: of the plant, by dotted name, other than they were at
    that age.

    Example:
        >>> from active_binocular_vision.learners.learners import FrozenLearners
        >>> learners = FrozenLearners("runs/first", settings={"camera.right_blur_px": 2.0})
        >>> learners.trained  # training iterations
        40
        >>> learners.atoms.shape  # scales, basis functions, pixels of both eyes
        (2, 32, 128)
        >>> from active_binocular_vision.learners.evaluation import evaluated
        >>> evaluated(learners).test.n_trials
        10
    """

    run: Path
    n_episodes: int | None = None
    dictionary: Path | None = None
    actor: Path | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Find the directory, of trained eyes too; InputError where there is none."""
        object.__setattr__(self, "run", existing_run(self.run))

    @classmethod
    def after(cls, run: Path, iteration: int) -> Self:
        """Return the learners of the checkpoint after so many training iterations of a run.

        Raises InputError, naming those that there are, without one.
        """
        run = existing_run(run)
        protocol = protocol_of(read_configuration(run / CONFIG_FILE))
        places = checkpoint.places(run / "checkpoints")
        trained = {protocol.training_iterations_before(place): place for place in places}
        if iteration not in trained:
            raise InputError(
                f"{run / 'checkpoints'}: expected a checkpoint after {iteration:,} training "
                f"iterations, there is one after {', '.join(map(str, trained)) or 'none'}"
            )
        return cls(run, trained[iteration])

    @cached_property
    def _checkpoint(self) -> tuple[Manifest, Path]:
        checkpoints = self.run / "checkpoints"
        if self.n_episodes is not None:
            found = checkpoint.at(checkpoints, self.n_episodes)
        elif (newest := checkpoint.newest(checkpoints)) is not None:
            found = newest
        else:
            raise InputError(f"{self.run}: expected a checkpoint, found none")
        return found

    @property
    def place(self) -> int:
        """Episodes that the run had done at the checkpoint; raises InputError without one."""
        return self._checkpoint[0].place

    @property
    def left(self) -> list[float]:
        """Activations of the commanded muscles with which the last training episode ended.

        Raises InputError where there was none before the checkpoint.
        """
        left = self._checkpoint[0].progress.left
        if not left:
            raise InputError(
                f"{self.run}: expected a checkpoint that says how training left the eyes, got one "
                f"after {self.place} episodes that does not"
            )
        return left

    @cached_property
    def _of_run(self) -> Configuration:
        return read_configuration(self.run / CONFIG_FILE)

    @cached_property
    def trained(self) -> int:
        """Training iterations before the checkpoint."""
        return protocol_of(self._of_run).training_iterations_before(self.place)

    @cached_property
    def configuration(self) -> Configuration:
        """The run's configuration as in a test at that age, except the settings.

        Without any schedule. Raises InputError for settings that the plant cannot have.
        """
        task = self._of_run["task"]
        schedule = read_schedule(task["schedule"])
        then = schedule.settings(schedule.stage(TEST, self.trained))
        started_with = config_of(EyePlantConfig, self._of_run)
        plant = flatten(changed(started_with, then | dict(self.settings)))
        eyes = {name: plant[name] for name in self._of_run["eyes"]}
        return self._of_run | {"eyes": eyes, "task": task | {"schedule": ""}}

    @cached_property
    def manager(self) -> ExperimentManagerConfig:
        """The experiment, with eyes of that age, except the settings."""
        return config_of(ExperimentManagerConfig, self.configuration)

    @cached_property
    def plant(self) -> EyePlantConfig:
        """The eyes of that age, except the settings."""
        return config_of(EyePlantConfig, self.configuration)

    @cached_property
    def atoms(self) -> NDArray[np.float32]:
        """The basis functions of all scales (n_scales, n_bases, 128)."""
        coder = SparseCoder(config_of(SparseCoderConfig, self.configuration))
        coder.restore(read_state(self._state("sparse_coder"), "sparse_coder"))
        return coder.atoms()

    @cached_property
    def tunings(self) -> tuple[Tuning, ...]:
        """What the basis functions of each scale are tuned to; the fits of two take 10 s."""
        return tunings(self.atoms, self.manager.scales)

    @cached_property
    def state_hash(self) -> str:
        """SHA-256 of both learners' states, in hexadecimal."""
        hashes = "".join(checkpoint.hash_of(self._state(name)) for name in _LEARNERS)
        return hashlib.sha256(hashes.encode()).hexdigest()

    def _state(self, name: str) -> Path:
        _, states = self._checkpoint
        other = self.dictionary if name == "sparse_coder" else self.actor
        return (other or states) / f"{name}.npz"

    @contextmanager
    def loop(self, shown: StimulusSet) -> Iterator[InProcessLoop]:
        """Yield plant and learners before stimuli, for episodes with learning=False.

        Raises InputError for a state that is damaged or does not fit.
        """
        loop = make_loop(self.configuration, shown)
        try:
            loop.restore({name: self._state(name) for name in _LEARNERS})
            yield loop
        finally:
            loop.plant.close()

    def said(self) -> dict[str, Any]:
        """Return what a document of measures says of them: model, seed, commit and so on.

        checkpoint: episodes before it; iteration: training iterations before it; states: their
        hash.
        """
        return {
            "model": self.manager.model,
            "seed": self.manager.seed,
            "commit": self.manager.commit,
            "lambda": self.manager.metabolic_cost_weight,
            "checkpoint": self.place,
            "iteration": self.trained,
            "states": self.state_hash,
            "dictionary": str(self.dictionary.resolve()) if self.dictionary else "",
            "actor": str(self.actor.resolve()) if self.actor else "",
            "settings": dict(self.settings),
        }
