"""The model in one file, docs/examples/k17.py, against the loop that all runs use."""

import importlib
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from eye_plant import EyePlant, load_stimuli
from lockstep.wire.topics import TEST
from tests.command_lines import configured
from tests.graph_harness import OracleRun, small_run

FILE = Path(__file__).parents[2] / "docs" / "examples" / "k17.py"
N_ITERATIONS, LAMBDA = 300, 0.065


@pytest.fixture
def k17(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The example, with a test at one distance that starts with errors of 0 deg and more."""
    monkeypatch.syspath_prepend(FILE.parent)
    module = importlib.import_module(FILE.stem)
    monkeypatch.setattr(module, "TEST_DISTANCES_M", (1.0,))
    monkeypatch.setattr(module, "LEAST_START_ERROR_DEG", 0)
    return module


def test_one_file_learns_what_the_loop_learns_bit_for_bit(k17: ModuleType, pictures: Path) -> None:
    line = small_run(pictures, N_ITERATIONS)
    oracle = OracleRun(configured(*line, "--model", "M_C", "--lambda", str(LAMBDA)))
    expected_deg = [
        abs(step.observation.truth.vergence_error_deg)
        for episode, step in oracle.steps()
        if episode.phase == TEST and episode.training_iteration and step.answer is None
    ]

    config = oracle.plant.config
    stimuli = load_stimuli(config.stimuli)
    plant, learner = EyePlant(config, stimuli), k17.Learner(1, N_ITERATIONS, LAMBDA)
    experiment = k17.Experiment(1, config, stimuli)
    k17.train(plant, learner, experiment)
    errors_deg = k17.tested_errors_deg(plant, learner, experiment, n_stimuli=1)
    plant.close()

    state = oracle.coder.state() | oracle.agent.state()
    learned = {
        "atoms": np.stack([dictionary.atoms for dictionary in learner.dictionaries]),
        "critic": learner.critic,
        "actor_hidden": learner.actor.hidden,
        "actor_output": learner.actor.output,
        "td_variance": np.array(learner.td_variance),
        "statistics_mean": learner.statistics.mean,
    }
    for name, array in learned.items():
        assert array.tobytes() == state[name].tobytes(), name
    assert errors_deg.tolist() == expected_deg
    assert len(expected_deg) == 4


def test_it_fits_on_a_few_pages() -> None:
    assert len(FILE.read_text().splitlines()) <= 250
