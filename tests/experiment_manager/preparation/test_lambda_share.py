"""--lambda-share: the price of energy that gives it a share of the reward."""

from pathlib import Path

import pytest
import yaml

from active_binocular_vision.commands import run_experiment
from active_binocular_vision.commands.command_line import arguments
from experiment_manager.experiment.protocol import protocol_of
from experiment_manager.in_process.loop import make_loop
from experiment_manager.preparation.lambda_share import (
    FirstIterations,
    first_iterations,
    with_weight,
)
from experiment_manager.run.config_file import read_configuration
from tests.command_lines import configured, set_words


def _line(pictures: Path, *more: str) -> list[str]:
    # An actor that does not learn acts the same whatever its reward.
    settings = {"eye_plant.stimuli.size_px": 64, "vergence_rl.cacla.actor_learning_rate": 0.0}
    line = ["--model", "M_C", "--iterations", "40", "--tests", "20", "--stimuli", str(pictures)]
    return [*line, *set_words(settings), *more]


def test_the_weight_of_a_share() -> None:
    # 0.25 * 1.5 / (0.3 + 0.25 * 1.5) = 0.375 / 0.675 = 5/9
    assert FirstIterations(10, 0.3, 1.5).weight_for(5 / 9) == pytest.approx(0.25)
    assert FirstIterations(10, 0.3, 1.5).weight_for(0.0) == 0.0


def test_the_means_are_over_whole_episodes(pictures: Path, monkeypatch) -> None:
    def measured(n_iterations: int) -> FirstIterations:
        monkeypatch.setattr(
            "experiment_manager.preparation.lambda_share.SHARE_ITERATIONS", n_iterations
        )
        return first_iterations(configured(*_line(pictures)))

    assert measured(25) == measured(30)


def test_the_rewards_of_a_run_have_the_share(pictures: Path) -> None:
    configuration = configured(*_line(pictures))
    first = first_iterations(configuration)
    assert first.n_iterations == 40
    weight = first.weight_for(0.3)
    loop = make_loop(with_weight(configuration, weight))
    reward = cost = 0.0
    for episode in protocol_of(configuration).training_episodes():
        for step in loop.run_episode(episode):
            if step.answer is not None:
                reward += step.answer.percept.reward
                cost += weight * step.answer.percept.metabolic_rate_w
    loop.plant.close()
    assert cost / -reward == pytest.approx(0.3, rel=1e-9)


def test_a_run_stores_it_and_a_resume_does_not_measure_again(
    pictures, tmp_path, capsys, monkeypatch
) -> None:
    out = tmp_path / "run"
    line = _line(pictures, "--lambda-share", "0.3", "--out", str(out))
    assert run_experiment.prepare(arguments(line)) == out
    expected = first_iterations(configured(*_line(pictures))).weight_for(0.3)
    configuration = read_configuration(out / "config.yaml")
    assert configuration["task"]["metabolic_cost_weight"] == expected
    run = yaml.safe_load((out / "config.yaml").read_text())["run"]["ros__parameters"]
    assert run["metabolic_cost_weight"] == expected
    text = capsys.readouterr().out
    assert f"lambda {expected:.6g} per W makes lambda C 0.3 of E + lambda C" in text

    monkeypatch.setattr(run_experiment, "first_iterations", pytest.fail)
    assert run_experiment.prepare(arguments(["--resume", str(out)])) == out
