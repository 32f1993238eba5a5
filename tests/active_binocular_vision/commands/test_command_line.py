"""The command line of run_experiment.sh as a request, and what --set says."""

import re

import pytest

from active_binocular_vision.commands.command_line import arguments, plant_settings, request_of
from experiment_manager import RunRequest
from lockstep import InputError


def test_a_request_has_the_words_that_made_it(tmp_path, monkeypatch) -> None:
    assert request_of(arguments([])) == RunRequest()
    monkeypatch.chdir(tmp_path)
    words = "--iterations 1e3 --lambda 0.020 --tests 0,5e2 --stimuli photos"
    line = [*words.split(), "--set", "vergence_rl.cacla.discount=5e-1"]
    assert request_of(arguments(line)) == RunRequest(
        iterations=1000,
        metabolic_cost_weight=0.02,
        tests=(0, 500),
        stimuli=str(tmp_path / "photos"),
        overrides={"vergence_rl.cacla.discount": 0.5},
        names={
            "iterations": "--iterations 1000",
            "metabolic_cost_weight": "--lambda 0.02",
            "tests": "--tests 0,500",
            "stimuli": "--stimuli photos",
            "vergence_rl.cacla.discount": "--set vergence_rl.cacla.discount=5e-1",
        },
    )


def test_a_setting_may_be_said_twice_if_it_is_the_same() -> None:
    line = ["--set", "vergence_rl.cacla.discount=0.5", "--set", "vergence_rl.cacla.discount=5e-1"]
    assert request_of(arguments(line)).overrides == {"vergence_rl.cacla.discount": 0.5}


@pytest.mark.parametrize(
    ("written", "text"),
    [
        ("2024", "2024"),
        ("'2024'", "2024"),
        ("true", "true"),
        ("", ""),
        ("/data/lab #2", "/data/lab #2"),
        ("/data/a: b", "/data/a: b"),
        ("/end ", "/end "),
    ],
)
def test_a_text_needs_no_quotes(written: str, text: str) -> None:
    line = ["--set", f"experiment_manager.run_id={written}"]
    assert request_of(arguments(line)).overrides == {"experiment_manager.run_id": text}


def test_a_home_directory_behind_an_equals_sign(monkeypatch) -> None:
    monkeypatch.setenv("HOME", "/home/me")
    options = arguments(["--out=~/runs/x", "--stimuli=$HOME/photos"])
    assert str(options.out) == "/home/me/runs/x"
    assert request_of(options).stimuli == "/home/me/photos"


def test_settings_of_the_plant_alone() -> None:
    texts = ["eyes.camera.left_blur_px=1e-1", "eyes.camera.renderer=mujoco"]
    assert plant_settings(texts) == {"camera.left_blur_px": 0.1, "camera.renderer": "mujoco"}
    for bad in ([*texts, texts[0]], ["vergence_rl.cacla.discount=0.5"]):
        with pytest.raises(InputError, match=re.escape(f"of this test once, got '{bad[-1]}'")):
            plant_settings(bad)
