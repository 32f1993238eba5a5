"""What eyes must reach for a protocol, and unlike eyes in a run."""

import json
import re
from pathlib import Path

import pytest

from active_binocular_vision.commands.run import main as run_experiment
from lockstep import MUSCLE_NAMES, InputError
from tests.command_lines import configured

_PROTOCOL = "experiment_manager"


def _strength(**changed: float) -> str:
    assert set(changed) <= set(MUSCLE_NAMES)
    values = [changed.get(name, 1.0) for name in MUSCLE_NAMES]
    return f"eyes.mechanics.strength={values}"


def _check(*settings: str, profile: str = "paper") -> None:
    configured("--profile", profile, *(w for setting in settings for w in ("--set", setting)))


def test_a_paralysed_muscle_is_allowed_where_the_protocol_can_be_met() -> None:
    _check(_strength(left_lateral_rectus=0.0))
    # One medial rectus reaches 8.78 deg: not the start of 3 deg beyond an object at 0.5 m.
    with pytest.raises(InputError, match=r"from 0.07 to 9.41 deg, .* reach -7.19 to 8.78 deg"):
        _check(_strength(right_medial_rectus=0.0))
    _check(_strength(right_medial_rectus=0.0), f"{_PROTOCOL}.least_start_error_deg=-2")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            (f"{_PROTOCOL}.start_version_deg=[20.0, 5.0]", f"{_PROTOCOL}.test_distances_m=[6.0]"),
            r"start_version_deg: expected \d+\.\d deg at most",
        ),
        (
            (f"{_PROTOCOL}.test_distances_m=[0.2, 1.0]",),
            r"converge by 0\.32 to 10\.72 deg, got 15\.\d\d deg",
        ),
        (("task.highest_activations=[0.02]",), r"reach an elevation of 5\.00 deg with a"),
        (
            ("task.highest_activations=[0.01]",),
            r"^mechanics: expected muscles that reach a torsional error of -4\.00 deg with a",
        ),
        (
            (_strength(**dict.fromkeys(MUSCLE_NAMES[:6], 0.0)),),
            r"reach a version of -5\.00 deg with a",
        ),
        (
            (
                f"{_PROTOCOL}.start_version_deg=[13.9, 0.0]",
                "task.highest_activations=[0.03]",
            ),
            r"reach a version of -13\.90 deg with a horizontal error of -3\.00, a vertical ",
        ),
    ],
)
def test_what_own_commands_cannot_meet_is_refused(settings: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=message):
        _check(*settings, profile="twelve")


def test_anatomical_eyes_meet_the_protocol() -> None:
    _check("eyes.mechanics.parameter_set=anatomical")


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        # At rest the eyes converge by 0.96 deg, and nothing is left to turn them out, or in.
        (
            (_strength(left_lateral_rectus=0.0, right_lateral_rectus=0.0),),
            r"reach vergences from 0\.\d\d to 9\.41 deg, .* these reach 0\.96 to ",
        ),
        (
            (_strength(left_medial_rectus=0.0, right_medial_rectus=0.0),),
            r"these reach -\d\.\d\d to 0\.96 deg",
        ),
        (
            ("task.highest_activations=[0.05, 0.1]",),
            r"with medial activations in \[0\.0, 0\.05\] and lateral ones in \[0\.0, 0\.1\]",
        ),
        (
            ("eyes.mechanics.rest_adduction_deg=[25.0, -25.0]",),
            r"they look 2\d\.\d deg to the right",
        ),
        (
            (
                "eyes.mechanics.parameter_set=anatomical",
                "task.highest_activations=[0.6]",
            ),
            r"expected muscles with one equilibrium for each pair of activations",
        ),
    ],
)
def test_what_cannot_be_met_is_refused_with_the_limits(settings, message) -> None:
    with pytest.raises(InputError, match=r"^mechanics: expected ") as caught:
        _check(*settings)
    assert re.search(message, str(caught.value))


def test_pairs_between_the_tested_vergences_must_have_one_rest_too() -> None:
    # At all distances of the protocol these do, but not at all vergences between those.
    with pytest.raises(InputError, match=r"^mechanics: expected muscles with one equilibrium"):
        _check("eyes.mechanics.parameter_set=anatomical", "task.highest_activations=[0.35]")


def test_a_run_with_a_paralysed_muscle_measures_each_eye(pictures: Path, tmp_path: Path) -> None:
    line = ["--in-process", "--iterations", "20", "--tests", "0", "--test-stimuli", "1"]
    line += ["--stimuli", str(pictures), "--out", str(tmp_path / "run")]
    line += ["--set", _strength(left_lateral_rectus=0.0)]
    line += ["--set", "eye_plant.stimuli.size_px=64", "--set", "task.n_bases=32"]
    line += ["--set", f"{_PROTOCOL}.test_distances_m=[3.0, 6.0]"]
    assert run_experiment(line) == 0
    first = json.loads((tmp_path / "run" / "results.json").read_text())["tests"][0]
    assert first["n_trials"] == 9
    # Of the lateral recti only the right one pulls: both eyes end turned to the right.
    assert first["median_left_deviation_deg"] > 0.1 > -0.1 > first["median_right_deviation_deg"]
    assert first["median_abs_version_deg"] > 0.1


def test_the_eyes_of_each_stage_must_meet_the_protocol() -> None:
    weak = [0.0 if name == "right_medial_rectus" else 1.0 for name in MUSCLE_NAMES]
    change = f"[{{at: 100, set: {{eyes.mechanics.strength: {weak}}}}}]"
    with pytest.raises(
        InputError, match="schedule, at 100: mechanics: expected muscles that reach"
    ):
        _check(f"task.schedule={change}")
    _check(f"task.schedule={change}", f"{_PROTOCOL}.least_start_error_deg=-2")


def _eyes_of(baseline_m: float, at: int) -> str:
    change = f"[{{at: {at}, set: {{eyes.mechanics.baseline_m: {baseline_m}}}}}]"
    return f"task.schedule={change}"


def test_the_trials_that_are_made_are_checked_not_those_of_another_baseline() -> None:
    only_near = [f"{_PROTOCOL}.{name}_distance_m=[0.5, 0.5]" for name in ("object", "fixation")]
    only_near += [f"{_PROTOCOL}.test_distances_m=[0.5]"]
    # At 0.5 m eyes 56 mm apart converge by 6.41 deg, and the tests begin with errors up to 6 deg.
    # With 70.5 mm it is 8.07 deg. A trial that begins with 8 deg would ask for 0.07 deg, but those
    # of 56 mm ask for 0.41 deg at least; lateral recti up to 0.008 give 0.32 deg.
    only_near.append("task.highest_activations=[0.2, 0.008]")
    _check(*only_near, _eyes_of(0.0705, 100))
    # With 30 mm it is 3.44 deg: -2.56 deg at the start of a trial of 6 deg.
    with pytest.raises(InputError, match=r"schedule, at 100: .* from -2\.56 to "):
        _check(*only_near, _eyes_of(0.03, 100))
