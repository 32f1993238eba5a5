"""The frozen learners of a checkpoint, tested in process, on any pictures."""

import dataclasses
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from tqdm import tqdm

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.loop import InProcessLoop, make_loop
from experiment_manager.measures.metrics import test_summary
from experiment_manager.measures.trials import mean_of_both_eyes
from experiment_manager.protocol import Protocol, make_protocol
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, Configuration, read_configuration
from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.stimuli.stimulus_set import StimulusSet, load_stimuli, load_unseen_stimuli
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.topics import HORIZONTAL_RECTI


@dataclass(frozen=True)
class FrozenTest:
    """What to test, and with what.

    run: directory with config.yaml and checkpoints/, the bag is not needed; place: episodes done
    at the checkpoint, None is the newest; stimuli: directory of pictures, None are the run's own
    test stimuli; n_stimuli: at most so many of them, None is as many as in the run's own tests.
    """

    run: Path
    place: int | None = None
    stimuli: Path | None = None
    n_stimuli: int | None = None

    def document(self) -> dict[str, Any]:
        """Make the test; return its summary as in results.json, and what it is a test of.

        Raises InputError for a run, checkpoint, state or picture that cannot be used.
        """
        configuration = read_configuration(self.run / CONFIG_FILE)
        manager = build(ExperimentManagerConfig, configuration["experiment_manager"])
        place, states = self._checkpoint()
        pictures = self._pictures(configuration, manager)
        protocol = _test_protocol(manager, place, len(pictures))
        loop = make_loop(configuration, StimulusSet((), pictures))
        loop.restore({name: states / f"{name}.npz" for name in loop.learners})
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
            "stimuli": str(self.stimuli.resolve()) if self.stimuli else "",
            "n_stimuli": len(pictures),
            "tests": [test_summary(rows)],
        }

    def _checkpoint(self) -> tuple[int, Path]:
        checkpoints = self.run / "checkpoints"
        if self.place is not None:
            manifest, states = checkpoint.at(checkpoints, self.place)
            return manifest.place, states
        found = checkpoint.newest(checkpoints)
        if found is None:
            raise InputError(f"{self.run}: expected a checkpoint, found none")
        return found[0].place, found[1]

    def _pictures(
        self, configuration: Configuration, manager: ExperimentManagerConfig
    ) -> tuple[np.ndarray, ...]:
        n_most = self.n_stimuli
        if n_most is None:
            n_most = manager.protocol.n_stimuli_per_test
        elif n_most < 1:
            raise InputError(f"stimuli per test: expected 1 or more, got {n_most}")
        config = build(EyePlantConfig, configuration["eye_plant"]).stimuli
        if self.stimuli is None:
            return load_stimuli(config).test[:n_most]
        return load_unseen_stimuli(str(self.stimuli), config, n_most)


def _test_protocol(config: ExperimentManagerConfig, place: int, n_stimuli: int) -> Protocol:
    """Return a protocol that ends where the checkpoint lies, with a single test."""
    whole = make_protocol(config)
    trained = whole.training_iterations_before(place)
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
