"""The frozen learners of a checkpoint, tested in process, on any pictures."""

import dataclasses
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.plant_changes import read_schedule
from experiment_manager.experiment.protocol import Protocol, make_protocol
from experiment_manager.loop import InProcessLoop, make_loop
from experiment_manager.measures.metrics import test_summary
from experiment_manager.measures.trials import mean_of_both_eyes
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, Configuration, read_configuration
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
from lockstep.configuration import build, flatten
from lockstep.errors import InputError
from lockstep.wire.topics import HORIZONTAL_RECTI, TEST

# How many random-dot stereograms are shown unless told otherwise.
_N_STEREOGRAMS = 10


@dataclass(frozen=True)
class FrozenTest:
    """What to test, and with what.

    run: directory with config.yaml and checkpoints/, the bag is not needed; place: episodes done
    at the checkpoint, None is the newest; n_stimuli: so many at most, None is as many as in the
    run's own tests. What is shown: stimuli, a directory of pictures; stereograms, a directory of
    pairs; random_dots, random-dot stereograms, nothing else; generated, the generated test stimuli,
    of a run that was trained on others; without any of them the run's own test stimuli.
    dictionary, actor: directories of checkpoints, of this run or another, whose dictionary or whose
    actor, with its critic, takes the place of the checkpoint's own. settings: of the plant, by
    dotted name, other than they were at that age.
    """

    run: Path
    place: int | None = None
    stimuli: Path | None = None
    n_stimuli: int | None = None
    stereograms: Path | None = None
    random_dots: bool = False
    generated: bool = False
    dictionary: Path | None = None
    actor: Path | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)

    def document(self) -> dict[str, Any]:
        """Make the test; return its summary as in results.json, and what it is a test of.

        Raises InputError for a run, checkpoint, state or picture that cannot be used.
        """
        found = read_configuration(self.run / CONFIG_FILE)
        place, states = self._checkpoint()
        manager = build(ExperimentManagerConfig, found["experiment_manager"])
        trained = make_protocol(manager).training_iterations_before(place)
        configuration, manager = _at_age(found, trained, self.settings)
        shown = self._shown(build(EyePlantConfig, configuration["eye_plant"]).stimuli, manager)
        n_stimuli = len(shown.all) + len(shown.stereograms)
        protocol = _test_protocol(manager, trained, n_stimuli)
        loop = make_loop(configuration, shown)
        loop.restore(
            {
                "sparse_coder": (self.dictionary or states) / "sparse_coder.npz",
                "vergence_rl": (self.actor or states) / "vergence_rl.npz",
            }
        )
        try:
            rows = _trial_rows(loop, protocol)
        finally:
            loop.plant.close()
        return {
            "model": manager.model,
            "seed": manager.seed,
            "commit": manager.commit,
            "lambda": manager.metabolic_cost_weight,
            "checkpoint": place,
            "dictionary": str(self.dictionary.resolve()) if self.dictionary else "",
            "actor": str(self.actor.resolve()) if self.actor else "",
            "settings": dict(self.settings),
            "stimuli": self.shown,
            "n_stimuli": n_stimuli,
            "tests": [test_summary(rows)],
        }

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
        if self.place is not None:
            manifest, states = checkpoint.at(checkpoints, self.place)
            return manifest.place, states
        found = checkpoint.newest(checkpoints)
        if found is None:
            raise InputError(f"{self.run}: expected a checkpoint, found none")
        return found[0].place, found[1]

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


def _trial_rows(loop: InProcessLoop, protocol: Protocol) -> np.ndarray:
    """Return the observations of all trials, (n, len(TRIAL_NAMES))."""
    test = protocol.segments[-1]
    n_training = protocol.config.n_training_stimuli
    rows: list[tuple[float, ...]] = []
    places = range(test.first, test.first + test.n_episodes)
    for place in tqdm(places, desc="test", unit="trial", file=sys.stderr, dynamic_ncols=True):
        rows += _trial(loop, protocol.episode(place), n_training)
    return np.array(rows, dtype=np.float64)


def _trial(loop: InProcessLoop, episode: Episode, n_training: int) -> list[tuple[float, ...]]:
    # This plant holds test pictures alone, so they are counted from 0.
    shown = dataclasses.replace(episode, stimulus=episode.stimulus - n_training)
    observations = [step.observation for step in loop.run_episode(shown, learning=False)]
    names = loop.plant.oculomotor.muscle_names
    recti = [names.index(name) for name in HORIZONTAL_RECTI]
    return [
        (*o.ground_truth_values(), *mean_of_both_eyes(o.state.activations[recti]))
        for o in observations
    ]
