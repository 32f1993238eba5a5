"""Runs whose muscles have commands of their own: their small files, without a bag."""

from pathlib import Path

import numpy as np

from experiment_manager import EvaluationSettings, Trials, summary_of
from experiment_manager.measures.kept_trials import with_test, write_trials
from experiment_manager.measures.results import CostShares, Results, write_document
from experiment_manager.run.config_file import parameters_in
from lockstep.command_space import COMMAND_SPACES
from tests.made_runs import config_text

N_ITERATIONS = 20
_DISTANCES_M = (0.5, 3.0, 6.0)
_N_STARTS, _N_STIMULI = 4, 2


def write_run(directory: Path, command_space: str, model: str = "M", weight: float = 0.0) -> Path:
    """Write the files of a run with tests after 0 and 1,000 iterations; return its directory."""
    task = {
        "command_space": command_space,
        "lowest_activations": [0.0],
        "highest_activations": [0.2],
    }
    text = config_text(model, 1, 1000, weight, **task)
    criteria = EvaluationSettings.of(parameters_in(text)).criteria(0)
    tests = [random_test(command_space, at, weight) for at in (0, 1000)]
    kept = None
    for test in tests:
        kept = with_test(kept, test)
    results = Results(
        model=model,
        profile="",
        seed=1,
        iterations=1000,
        commit="0123abc",
        metabolic_cost_weight=weight,
        cost_shares=CostShares(None, None),
        tests=tuple(summary_of(test, criteria) for test in tests),
    )
    directory.mkdir(parents=True)
    (directory / "config.yaml").write_text(text)
    write_document(directory / "results.json", results)
    write_trials(directory, kept)
    return directory


def random_test(command_space: str, training_iteration: int, weight: float = 0.0) -> Trials:
    """Trials that begin alike in every test, with random errors and activations; errors shrink.

    The higher the price of energy, its weight, the lower are the metabolic rates.
    """
    space = COMMAND_SPACES[command_space]
    n_trials = len(_DISTANCES_M) * _N_STARTS * _N_STIMULI
    start, draw = (np.random.default_rng(seed) for seed in (0, 1 + training_iteration))
    shape = (n_trials, N_ITERATIONS + 1)
    columns = {
        "stimulus": np.repeat(np.arange(_N_STIMULI), n_trials // _N_STIMULI),
        "object_distance_m": np.resize(_DISTANCES_M, n_trials),
        "optimal_metabolic_rate_w": np.full(n_trials, 0.5),
    }
    columns = {
        name: np.repeat(values[:, None], shape[1], axis=1) for name, values in columns.items()
    }
    for name in ("vergence_error_deg", "vertical_error_deg", "cyclovergence_error_deg"):
        columns[name] = draw.uniform(-3.0, 3.0, shape) / (1 + np.arange(shape[1]))
        columns[name][:, 0] = start.uniform(-3.0, 3.0, n_trials)
    columns["metabolic_rate_w"] = draw.uniform(0.5, 1.5, shape) / (1 + weight)
    columns["metabolic_rate_w"][:, 0] = start.uniform(1.5, 2.0, n_trials)
    columns |= {name: draw.uniform(0.0, 0.2, shape) for name in space.names}
    return Trials(space, training_iteration, np.arange(n_trials), columns, np.zeros(shape, int))
