"""The rule as docs/model/hindsight.md describes it, rewritten, gives the product's commands.

docs/examples/hindsight.py was written from the page; both see the same observations.
"""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from lockstep.wire.topics import TRAINING
from tests.command_lines import configured
from tests.graph_harness import OracleRun, small_run
from tests.vergence_rl.small_agents import changed, experience
from vergence_rl import Agent, VergenceRlConfig

FILE = Path(__file__).parents[3] / "docs" / "examples" / "hindsight.py"
SMALL = VergenceRlConfig(learning_rule="hindsight", n_bases=3, feature_exponent=0.5)
SETTINGS = {
    "n_best": "hindsight.n_best",
    "starts": "hindsight.starts_share",
    "rho_samples": "hindsight.ridge_visits",
    "rho_own": "hindsight.felt_ridge_share",
    "memory": "hindsight.memory_share",
    "k": "hindsight.target_noise_scale",
    "floor": "hindsight.least_noise_share",
}


@pytest.fixture(scope="module")
def page() -> ModuleType:
    spec = importlib.util.spec_from_file_location("hindsight_from_the_page", FILE)
    assert spec
    assert spec.loader
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look there
    spec.loader.exec_module(module)
    return module


def _rule(page: ModuleType, config: VergenceRlConfig, **settings: float):
    return page.HindsightRegression(
        page.Settings(**settings), config.seed, config.n_features, *config.limit_arrays
    )


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"n_best": 5, "starts": 0.3, "rho_samples": 100.0, "memory": 0.15},
        {"n_best": 4, "rho_own": 0.05, "k": 3.0, "floor": 0.06},
    ],
    ids=["precise", "twelve", "as where it turns eyes"],
)
def test_it_gives_the_same_commands_for_a_thousand_iterations(
    page: ModuleType, settings: dict[str, float]
) -> None:
    config = changed(SMALL, {SETTINGS[name]: value for name, value in settings.items()})
    agent, rule = Agent(config), _rule(page, config, **settings)
    n_moved = 0
    for n in range(1_000):
        features, x, reward = experience(n)
        iteration = n % 10
        is_training = n % 90 < 80  # and a trial now and then, from which nothing is learned
        decision = agent.observe(
            *(features, x, reward, iteration, n), learning=is_training, exploration=is_training
        )
        command = rule.step(features.ravel(), x, reward, iteration, n, training=is_training)
        np.testing.assert_allclose(command, decision.command, rtol=0, atol=1e-9, err_msg=str(n))
        n_moved += bool(np.any(decision.command != np.clip(x, *config.limit_arrays)))
    assert n_moved > 900


@pytest.mark.parametrize("n_iterations", [300])
def test_it_gives_the_commands_of_a_run_of_the_profile_precise(
    page: ModuleType, pictures: Path, n_iterations: int
) -> None:
    line = small_run(pictures, n_iterations)
    oracle = OracleRun(configured("--profile", "precise", *line[2:]))
    rule = _rule(page, oracle.agent.config)
    space = oracle.agent.config.space
    largest = 0.0
    for episode, step in oracle.steps():
        seen, answer = step.observation, step.answer
        if answer is None or episode.phase != TRAINING:
            continue
        command = rule.step(
            answer.percept.encoding.features.ravel(),
            space.from_all(seen.felt),
            answer.percept.reward,
            seen.iteration,
            seen.training_iteration,
            training=True,
        )
        largest = max(largest, float(np.abs(command - answer.decision.command).max()))
    assert largest < 1e-9
    assert rule.count == n_iterations
    assert np.any(rule.actor)
