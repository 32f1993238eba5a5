"""sweeps/lambda_share.py: the lambda that gives energy a share of the reward."""

import re
import runpy
import sys
from pathlib import Path

import pytest

from experiment_manager import make_loop, protocol_of
from tests.command_lines import configured, set_words

SCRIPT = Path(__file__).parents[2] / "sweeps" / "lambda_share.py"


def test_the_rewards_of_a_run_have_the_share(pictures: Path, monkeypatch, capsys) -> None:
    # An actor that does not learn acts the same whatever its reward.
    settings = {"eye_plant.stimuli.size_px": 64, "vergence_rl.cacla.actor_learning_rate": 0.0}
    line = ["--model", "M_C", "--iterations", "40", "--tests", "20", "--stimuli", str(pictures)]
    line += set_words(settings)
    monkeypatch.setattr(sys, "argv", [str(SCRIPT), "0.3", *line])
    runpy.run_path(str(SCRIPT), run_name="__main__")
    found = re.search(r"40 iterations: .* lambda (\S+) per W", capsys.readouterr().out)
    assert found is not None
    weight = float(found[1])
    configuration = configured(*line, "--lambda", found[1])
    loop = make_loop(configuration)
    reward = cost = 0.0
    for episode in protocol_of(configuration).training_episodes():
        for step in loop.run_episode(episode):
            if step.answer is not None:
                reward += step.answer.percept.reward
                cost += weight * step.answer.percept.metabolic_rate_w
    loop.plant.close()
    assert cost / -reward == pytest.approx(0.3, rel=1e-5)  # as many digits as are printed
