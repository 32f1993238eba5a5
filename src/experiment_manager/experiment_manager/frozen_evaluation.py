"""The frozen learners of a checkpoint, tested in process, on any pictures."""

import dataclasses
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.experiment.config import ExperimentManagerConfig, ProtocolConfig
from experiment_manager.experiment.plant_changes import read_schedule
from experiment_manager.experiment.protocol import Protocol, make_protocol
from experiment_manager.loop import InProcessLoop, make_loop
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.metrics import summary_of
from experiment_manager.measures.results import Summary
from experiment_manager.measures.trials import TrialTable, only_test
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, Configuration, read_configuration
from experiment_manager.run.progress_lines import progress
from eye_plant.config import EyePlantConfig, changed
from eye_plant.episode import Episode
from eye_plant.stimuli.stereograms import random_dot_stereograms, read_stereograms
from eye_plant.stimuli.stimulus_set import (
    SMALLEST_PX,
    StimuliConfig,
    StimulusSet,
    load_stimuli,
    load_unseen_stimuli,
)
from lockstep.command_space import PAIR
from lockstep.configuration import build, flatten
from lockstep.errors import InputError
from lockstep.wire.topics import TEST

# How many random-dot stereograms are shown by default.
_N_STEREOGRAMS = 10


@dataclass(frozen=True)
class FrozenEvaluation:
    """What to test, and with what.

    run: directory with config.yaml and checkpoints/, the bag is not needed; n_episodes: done at the
    checkpoint, None is the newest; n_stimuli: so many at most, None is as many as in the
    run's own tests. What is shown: stimuli, a directory of pictures; stereograms, a directory of
    pairs; random_dots, random-dot stereograms, nothing else; generated, the generated test stimuli,
    of a run that was trained on others; without any of them the run's own test stimuli.
    dictionary, actor: directories of checkpoints, of this run or another, whose dictionary or whose
    actor, with its critic, takes the place of the checkpoint's own. settings: of the plant, by
    dotted name, other than they were at that age. start_scale: how many times as far off trials
    begin as in the run's own tests, in errors and version, of eyes with a command for each muscle.
    """

    run: Path
    n_episodes: int | None = None
    stimuli: Path | None = None
    n_stimuli: int | None = None
    stereograms: Path | None = None
    random_dots: bool = False
    generated: bool = False
    dictionary: Path | None = None
    actor: Path | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    start_scale: float = 1.0

    def results(self) -> "FrozenResults":
        """Make the test; return its summary, and what it is a test of.

        Raises InputError for a run, checkpoint, state or picture that cannot be used.
        """
        of_run = read_configuration(self.run / CONFIG_FILE)
        n_episodes, states = self._checkpoint()
        manager = build(ExperimentManagerConfig, of_run["experiment_manager"])
        trained = make_protocol(manager).training_iterations_before(n_episodes)
        configuration, manager = _at_age(of_run, trained, self.settings)
        plant = build(EyePlantConfig, configuration["eye_plant"])
        criteria = criteria_of(plant, manager.protocol.fixation_iterations)
        shown = self._shown(plant.stimuli, manager)
        n_stimuli = len(shown.all) + len(shown.stereograms)
        manager = dataclasses.replace(manager, protocol=self._with_starts(manager.protocol))
        protocol = _test_protocol(manager, trained, n_stimuli)
        table = self._tested(make_loop(configuration, shown), states, protocol)
        trials = only_test(table, manager.protocol.iterations_per_trial)
        return FrozenResults(
            model=manager.model,
            seed=manager.seed,
            commit=manager.commit,
            metabolic_cost_weight=manager.metabolic_cost_weight,
            checkpoint=n_episodes,
            dictionary=str(self.dictionary.resolve()) if self.dictionary else "",
            actor=str(self.actor.resolve()) if self.actor else "",
            settings=self.settings,
            start_scale=self.start_scale,
            stimuli=self.shown,
            n_stimuli=n_stimuli,
            test=summary_of(trials, criteria),
        )

    def _tested(self, loop: InProcessLoop, states: Path, protocol: Protocol) -> TrialTable:
        loop.restore(
            {
                "sparse_coder": (self.dictionary or states) / "sparse_coder.npz",
                "vergence_rl": (self.actor or states) / "vergence_rl.npz",
            }
        )
        try:
            return _trial_table(loop, protocol)
        finally:
            loop.plant.close()

    def _with_starts(self, protocol: ProtocolConfig) -> ProtocolConfig:
        if self.start_scale == 1.0:
            return protocol
        if protocol.command_space == PAIR:
            raise InputError(
                "start_scale: expected a run with a command for each muscle, whose first errors "
                "are drawn from ranges; those of the pair are whole degrees"
            )
        error_deg, version_deg = (
            tuple(self.start_scale * most for most in largest_deg)
            for largest_deg in (protocol.start_error_deg, protocol.start_version_deg)
        )
        return dataclasses.replace(
            protocol, start_error_deg=error_deg, start_version_deg=version_deg
        )

    @property
    def shown(self) -> str:
        """What is shown, in words; "" for the run's own test stimuli."""
        if self.random_dots:
            return "random-dot stereograms"
        if self.generated:
            return "the generated test stimuli"
        directory = self.stimuli or self.stereograms
        return str(directory.resolve()) if directory else ""

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

    def _shown(self, config: StimuliConfig, manager: ExperimentManagerConfig) -> StimulusSet:
        directories = (self.stimuli is not None, self.stereograms is not None)
        if sum((*directories, self.random_dots, self.generated)) > 1:
            raise InputError(
                "expected one of a directory, stereograms, random dots and generated stimuli, "
                "got more"
            )
        n_most = self.n_stimuli
        if n_most is None:
            n_most = _N_STEREOGRAMS if self.random_dots else manager.protocol.n_stimuli_per_test
        elif n_most < 1:
            raise InputError(f"stimuli per test: expected 1 or more, got {n_most}")
        if self.random_dots:
            dots = random_dot_stereograms(config.seed, n_most, config.size_px)
            return StimulusSet((), (), dots)
        if self.stereograms is not None:
            directory = str(self.stereograms)
            pairs = read_stereograms(directory, config.seed, n_most, config.size_px, SMALLEST_PX)
            return StimulusSet((), (), pairs)
        if self.generated:
            config = dataclasses.replace(config, directory="")
        if self.stimuli is None:
            return StimulusSet((), load_stimuli(config).test[:n_most])
        return StimulusSet((), load_unseen_stimuli(str(self.stimuli), config, n_most))


@dataclass(frozen=True, kw_only=True)
class FrozenResults:
    """What frozen learners did in a test.

    checkpoint: episodes that its run had done; dictionary, actor: directories of the checkpoints
    that took their place, "" for none; settings: of the plant, other than at the learners' age;
    start_scale: of the first errors; stimuli: what was shown, in words, "" for the run's own.
    """

    model: str
    seed: int
    commit: str
    metabolic_cost_weight: float
    checkpoint: int
    dictionary: str
    actor: str
    settings: Mapping[str, Any]
    start_scale: float
    stimuli: str
    n_stimuli: int
    test: Summary

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        names = {"metabolic_cost_weight": "lambda"}
        document = {names.get(name, name): value for name, value in vars(self).items()}
        del document["test"]
        return document | {"settings": dict(self.settings), "tests": [self.test.to_json()]}


def _at_age(
    configuration: Configuration, trained: int, settings: Mapping[str, Any]
) -> tuple[Configuration, ExperimentManagerConfig]:
    """Return a run's configuration as it was at an age, but for the settings, and the manager's.

    That of a test after so many training iterations, without any schedule.
    """
    schedule = read_schedule(configuration["experiment_manager"]["schedule"])
    then = schedule.settings(schedule.stage(TEST, trained))
    started_with = build(EyePlantConfig, configuration["eye_plant"])
    plant = flatten(changed(started_with, then | dict(settings)))
    mechanics = {name: v for name, v in plant.items() if name.startswith("mechanics.")}
    manager = configuration["experiment_manager"] | mechanics | {"schedule": ""}
    return (
        configuration | {"eye_plant": plant, "experiment_manager": manager},
        build(ExperimentManagerConfig, manager),
    )


def _test_protocol(config: ExperimentManagerConfig, trained: int, n_stimuli: int) -> Protocol:
    """Return a protocol that ends after so many training iterations, with a single test."""
    tested = dataclasses.replace(
        config.protocol,
        n_training_iterations=trained,
        test_iterations=(trained,),
        n_test_stimuli=n_stimuli,
        n_stimuli_per_test=n_stimuli,
    )
    return make_protocol(dataclasses.replace(config, protocol=tested))


def _trial_table(loop: InProcessLoop, protocol: Protocol) -> TrialTable:
    """Return the observations of all trials."""
    test = protocol.segments[-1]
    n_training = protocol.config.n_training_stimuli
    rows: list[tuple[float, ...]] = []
    numbers = range(test.first, test.first + test.n_episodes)
    for i in progress(numbers, file=sys.stderr, desc="test", unit="trial"):
        rows += _trial(loop, protocol.episode(i), n_training)
    return TrialTable(np.array(rows, dtype=np.float64))


def _trial(loop: InProcessLoop, episode: Episode, n_training: int) -> list[tuple[float, ...]]:
    # This plant holds test pictures alone, so they are counted from 0.
    shown = dataclasses.replace(episode, stimulus=episode.stimulus - n_training)
    observations = [step.observation for step in loop.run_episode(shown, learning=False)]
    space = loop.plant.config.space
    return [(*o.ground_truth_values(), *space.from_all(o.state.activations)) for o in observations]
