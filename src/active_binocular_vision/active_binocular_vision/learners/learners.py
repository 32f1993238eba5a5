"""The learners of a checkpoint, with the eyes they had then or with others."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.plant_changes import read_schedule
from experiment_manager.experiment.protocol import protocol_of
from experiment_manager.experiment.sections import Configuration, config_of
from experiment_manager.in_process.loop import InProcessLoop, make_loop
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from eye_plant import EyePlantConfig, StimulusSet
from eye_plant.config import changed
from lockstep import InputError, flatten
from lockstep.wire.topics import TEST


@dataclass(frozen=True)
class FrozenLearners:
    """Which learners, with which eyes.

    run: directory with config.yaml and checkpoints/, the bag is not needed; n_episodes: done at the
    checkpoint, None is the newest; dictionary, actor: directories of checkpoints, of this run or
    another, whose dictionary or whose actor, with its critic, takes the place of the checkpoint's
    own; settings: of the plant, by dotted name, other than they were at that age.
    """

    run: Path
    n_episodes: int | None = None
    dictionary: Path | None = None
    actor: Path | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)

    @cached_property
    def _checkpoint(self) -> tuple[int, Path]:
        checkpoints = self.run / "checkpoints"
        if self.n_episodes is not None:
            found = checkpoint.at(checkpoints, self.n_episodes)
        elif (newest := checkpoint.newest(checkpoints)) is not None:
            found = newest
        else:
            raise InputError(f"{self.run}: expected a checkpoint, found none")
        manifest, states = found
        return manifest.place, states

    @property
    def place(self) -> int:
        """Episodes that the run had done at the checkpoint; raises InputError without one."""
        return self._checkpoint[0]

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

    @contextmanager
    def loop(self, shown: StimulusSet) -> Iterator[InProcessLoop]:
        """Yield plant and learners before stimuli, for episodes with learning=False.

        Raises InputError for a state that is damaged or does not fit.
        """
        _, states = self._checkpoint
        loop = make_loop(self.configuration, shown)
        try:
            loop.restore(
                {
                    "sparse_coder": (self.dictionary or states) / "sparse_coder.npz",
                    "vergence_rl": (self.actor or states) / "vergence_rl.npz",
                }
            )
            yield loop
        finally:
            loop.plant.close()

    def said(self) -> dict[str, Any]:
        """Return what a document of measures says of them: model, seed, commit and so on."""
        return {
            "model": self.manager.model,
            "seed": self.manager.seed,
            "commit": self.manager.commit,
            "lambda": self.manager.metabolic_cost_weight,
            "checkpoint": self.place,
            "dictionary": str(self.dictionary.resolve()) if self.dictionary else "",
            "actor": str(self.actor.resolve()) if self.actor else "",
            "settings": dict(self.settings),
        }
