"""What a run is asked to be: one value of each parameter, under the name that the user gave it."""

import datetime
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from experiment_manager.preparation.request import Given, RunRequest
from lockstep import InputError

FULL = RunRequest(
    profile="precise_m_c",
    model="M_C",
    iterations=2000,
    seed=3,
    stimuli="/pictures",
    metabolic_cost_weight=0.02,
    tests=(0, 1000),
    test_stimuli=2,
    overrides={
        "eyes.camera.left_blur_px": 1e-5,
        "task.highest_activations": (0.0, 0.3),
    },
    names={"iterations": "--iterations 2e3"},
)


def test_what_is_asked_is_settings_of_parameters() -> None:
    settings = FULL.settings()
    assert {key: given.value for key, given in settings.items()} == {
        "experiment_manager.model": "M_C",
        "task.n_training_iterations": 2000,
        "task.seed": 3,
        "task.metabolic_cost_weight": 0.02,
        "experiment_manager.test_iterations": [0, 1000],
        "experiment_manager.n_stimuli_per_test": 2,
        "eye_plant.stimuli.directory": "/pictures",
        "eyes.camera.left_blur_px": 1e-5,
        "task.highest_activations": [0.0, 0.3],
    }
    assert settings["task.n_training_iterations"] == Given(2000, "--iterations 2e3")
    assert settings["task.seed"].by == "seed"
    assert RunRequest().settings() == {}


def test_a_control_is_settings_that_nobody_may_contradict() -> None:
    key = "experiment_manager.tonic_start_spread"
    names = {"control": "--control"}
    assert RunRequest(control="starts_tonic").settings()[key].value == 0.002
    with pytest.raises(InputError, match=f"--control and {key}: expected one value"):
        RunRequest(control="starts_tonic", overrides={key: 0.1}, names=names).settings()
    with pytest.raises(InputError, match=r"--control: .*did you mean random_reward"):
        RunRequest(control="random_rewards", names=names)


@pytest.mark.parametrize(
    ("key", "value", "kept"),
    [
        ("vergence_rl.cacla.discount", math.inf, math.inf),
        ("eye_plant.stimuli.directory", "photos", "photos"),
        ("eye_plant.stimuli.directory", Path("photos"), "photos"),
        ("task.highest_activations", (0.0, 0.3), [0.0, 0.3]),
        ("task.highest_activations", np.array([0.0, 0.3]), [0.0, 0.3]),
        ("task.highest_activations", [np.float32(0.5), np.float64(0.3)], [0.5, 0.3]),
        ("task.seed", np.int64(3), 3),
        ("eyes.camera.left_occluded", np.True_, True),
        ("task.schedule", [{"at": 10, "set": {}}], '[{"at": 10, "set": {}}]'),
        ("task.schedule", "1e5", "1e5"),
        ("vergence_rl.own_rule", {"rate": 0.5}, '{"rate": 0.5}'),
        ("vergence_rl.learning_rule", "my/rule.py:Rule", f"{Path.cwd()}/my/rule.py:Rule"),
        ("vergence_rl.learning_rule", "my.rules:Rule", "my.rules:Rule"),
    ],
)
def test_overrides_are_kept_as_parameters_have_them(key: str, value: Any, kept: Any) -> None:
    assert RunRequest(overrides={key: value}).overrides == {key: kept}


@pytest.mark.parametrize(
    ("values", "error"),
    [
        ({"model": "X", "names": {"model": "--model X"}}, "--model X: expected M or M_C, got 'X'"),
        ({"overrides": {"vergence.discount": 1}}, "with a section of .*; did you mean vergence_rl"),
        ({"overrides": {"vergence_rl": 1}}, "vergence_rl: expected SECTION.NAME with a section of"),
        (
            {"overrides": {"vergence_rl.cacla.discount": datetime.date(2024, 1, 1)}},
            "vergence_rl.cacla.discount: expected numbers, texts, .* got the date 2024-01-01",
        ),
        (
            {"overrides": {"eye_plant.stimuli.directory": {"photos"}}},
            "eye_plant.stimuli.directory: expected numbers, texts, .* got the set {'photos'}",
        ),
    ],
)
def test_what_no_run_can_be_is_refused_at_once(values: dict[str, Any], error: str) -> None:
    with pytest.raises(InputError, match=error):
        RunRequest(**values)
