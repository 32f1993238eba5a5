"""A test of the frozen learners of a checkpoint, in process, on any pictures."""

import dataclasses
import sys
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from experiment_manager import (
    ExperimentManagerConfig,
    InProcessLoop,
    Protocol,
    Summary,
    make_protocol,
    summary_of,
)
from experiment_manager.measures.criteria import criteria_of
from experiment_manager.measures.trials import TrialTable, only_test
from eye_plant import Episode
from lockstep import PAIR, InputError
from lockstep.machine.progress_lines import progress

# How many random-dot stereograms a test shows by default.
_N_STEREOGRAMS = 10


@dataclass(frozen=True)
class FrozenResults:
    """What frozen learners did in a test.

    learners: what a document says of them; start_scale, start_errors: of the first errors; stimuli:
    what was shown, in words, "" for the run's own.
    """

    learners: FrozenLearners
    start_scale: float
    start_errors: str
    stimuli: str
    n_stimuli: int
    test: Summary

    def to_json(self) -> dict[str, Any]:
        """Return what abv examine writes."""
        return self.learners.said() | {
            "start_scale": self.start_scale,
            "start_errors": self.start_errors,
            "stimuli": self.stimuli,
            "n_stimuli": self.n_stimuli,
            "tests": [msgspec.to_builtins(self.test)],
        }


def evaluated(
    learners: FrozenLearners,
    shown: Shown = OWN_TEST_STIMULI,
    start_scale: float = 1.0,
    start_errors: str | None = None,
) -> FrozenResults:
    """Make the test; return its summary, and what it is a test of.

    start_scale: how many times as far off trials begin as in the run's own tests, in errors and
    version, of eyes with a command for each muscle; start_errors: of the pair, START_ERRORS instead
    of the run's. Raises InputError for a run, checkpoint, state
    or picture that cannot be used.
    """
    manager = learners.manager
    criteria = criteria_of(learners.plant, manager.fixation_iterations)
    n_default = _N_STEREOGRAMS if shown.random_dots else manager.n_stimuli_per_test
    stimuli = shown.load(learners.plant.stimuli, n_default)
    n_stimuli = stimuli.n_pictures
    started = _with_starts(manager, start_scale, start_errors)
    protocol = _test_protocol(started, learners.trained, n_stimuli)
    with learners.loop(stimuli) as loop:
        table = _trial_table(loop, protocol)
    trials = only_test(table, manager.iterations_per_trial)
    test = summary_of(trials, criteria)
    return FrozenResults(learners, start_scale, started.start_errors, shown.text, n_stimuli, test)


def _with_starts(
    protocol: ExperimentManagerConfig, start_scale: float, start_errors: str | None
) -> ExperimentManagerConfig:
    if start_errors is not None:
        if protocol.turning_space != PAIR:
            raise InputError(
                "start_errors: expected a run of the pair; with a command for each muscle first "
                "errors are drawn"
            )
        protocol = dataclasses.replace(protocol, start_errors=start_errors)
    if start_scale == 1.0:
        return protocol
    if protocol.turning_space == PAIR:
        raise InputError(
            "start_scale: expected a run with a command for each muscle, whose first errors "
            "are drawn from ranges; those of the pair are whole degrees"
        )
    error_deg, version_deg = (
        tuple(start_scale * most for most in largest_deg)
        for largest_deg in (protocol.start_error_deg, protocol.start_version_deg)
    )
    return dataclasses.replace(protocol, start_error_deg=error_deg, start_version_deg=version_deg)


def _test_protocol(config: ExperimentManagerConfig, trained: int, n_stimuli: int) -> Protocol:
    """Return a protocol that ends after so many training iterations, with a single test."""
    tested = dataclasses.replace(
        config,
        n_training_iterations=trained,
        test_iterations=(trained,),
        n_test_stimuli=n_stimuli,
        n_stimuli_per_test=n_stimuli,
    )
    return make_protocol(tested)


def _trial_table(loop: InProcessLoop, protocol: Protocol) -> TrialTable:
    """Return the observations of all trials."""
    test = protocol.segments[-1]
    n_training = protocol.config.n_training_stimuli
    rows: list[tuple[float, ...]] = []
    numbers = range(test.first, test.first + test.n_episodes)
    for i in progress(numbers, file=sys.stderr, desc="test", unit="trial"):
        rows += _trial(loop, protocol.episode(i), n_training)
    return TrialTable(np.array(rows, dtype=np.float64), protocol.config.space)


def _trial(loop: InProcessLoop, episode: Episode, n_training: int) -> list[tuple[float, ...]]:
    # This plant holds test pictures alone, so they are counted from 0.
    shown = dataclasses.replace(episode, stimulus=episode.stimulus - n_training)
    observations = [step.observation for step in loop.run_episode(shown, learning=False)]
    space = loop.plant.config.space
    return [(*o.ground_truth_values(), *space.from_all(o.activations)) for o in observations]
