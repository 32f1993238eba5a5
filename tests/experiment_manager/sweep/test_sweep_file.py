"""What a sweep's file says, and what it may not say."""

from pathlib import Path

import pytest

from active_binocular_vision.command_lines.run import parser
from experiment_manager import configuration_of
from experiment_manager.preparation.request import OPTIONS
from experiment_manager.sweep.sweep_file import Sweep, read_sweep
from lockstep import InputError
from tests.command_lines import configured
from tests.sweep_harness import command_line, write_sweep

SWEEPS = Path(__file__).parents[3] / "sweeps"


def read(tmp_path: Path, text: str, stimuli: Path | None = None) -> Sweep:
    path = tmp_path / "sweep.yaml"
    path.write_text(text)
    return read_sweep(path, stimuli)


def test_each_combination_is_a_run_named_after_its_values(tmp_path: Path) -> None:
    sweep = read(
        tmp_path,
        "options: {profile: paper, iterations: 1e5, task.n_bases: 32}\n"
        "axes: {model: [M, M_C], vergence_rl.cacla.discount: [0.3, 1e-5]}\n",
    )
    runs = sweep.runs()
    assert [*runs] == [
        "model_M-discount_0.3",
        "model_M-discount_1e-05",
        "model_M_C-discount_0.3",
        "model_M_C-discount_1e-05",
    ]
    request = runs["model_M_C-discount_1e-05"]
    assert (request.profile, request.iterations, request.model) == ("paper", 100_000, "M_C")
    assert request.overrides == {"task.n_bases": 32, "vergence_rl.cacla.discount": 1e-5}


def test_an_entry_may_set_several_together(tmp_path: Path) -> None:
    sweep = read(
        tmp_path,
        "description: why\naxes:\n"
        "  seed: [{seed: 1, eye_plant.stimuli.seed: 101}, {eye_plant.stimuli.seed: 102, seed: 2}]\n"
        "  lambda: [0, {lambda: 0.1, model: M_C}]\n",
    )
    runs = sweep.runs()
    assert [*runs] == [
        "seed_1-lambda_0",
        "seed_1-lambda_0.1",
        "seed_2-lambda_0",
        "seed_2-lambda_0.1",
    ]
    pictures = [request.overrides["eye_plant.stimuli.seed"] for request in runs.values()]
    assert pictures == [101, 101, 102, 102]
    assert [request.seed for request in runs.values()] == [1, 1, 2, 2]
    assert [request.model for request in runs.values()] == [None, "M_C", None, "M_C"]
    assert read(tmp_path, sweep.text()) == sweep  # as it keeps itself


def test_a_run_is_that_of_its_command_line(tmp_path: Path, pictures: Path) -> None:
    entries: list[object] = [1, {"seed": 2, "eyes.camera.left_blur_px": 0.5}]
    sweep = read_sweep(write_sweep(tmp_path / "s.yaml", pictures, {"seed": entries}))
    lines = (
        command_line(pictures, seed=1),
        command_line(pictures, seed=2, **{"eyes.camera.left_blur_px": 0.5}),
    )
    for request, line in zip(sweep.runs().values(), lines, strict=True):
        assert configuration_of(request, "0123abc") == configured(*line)


@pytest.mark.parametrize(
    ("axes", "name"),
    [
        ("eye_plant.stimuli.seed: [1], task.seed: [2]", "eye_plant.stimuli.seed_1-task.seed_2"),
        ("tests: [[0, 10]], profile: [rearing/aligned]", "tests_0_10-profile_rearing_aligned"),
    ],
)
def test_names_are_directories_of_their_own(tmp_path: Path, axes: str, name: str) -> None:
    assert [*read(tmp_path, f"axes: {{{axes}}}").runs()] == [name]


@pytest.mark.parametrize("name", ["stimuli", "eye_plant.stimuli.directory"])
def test_directories_of_images_are_kept_absolute(tmp_path, monkeypatch, name) -> None:
    monkeypatch.chdir(tmp_path)
    photos = str(tmp_path / "photos")
    axes = read(tmp_path, f"axes: {{{name}: [photos, '', {{{name}: more, seed: 1}}]}}").axes
    assert axes[name] == [photos, "", {name: str(tmp_path / "more"), "seed": 1}]
    option = read(tmp_path, f"options: {{{name}: photos}}\naxes: {{seed: [1]}}")
    assert option.options[name] == photos


def test_the_file_of_a_rule_is_kept_absolute(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    axes = read(tmp_path, "axes: {vergence_rl.learning_rule: ['my.py:Rule', cacla]}").axes
    assert axes["vergence_rl.learning_rule"] == [f"{tmp_path}/my.py:Rule", "cacla"]


def test_a_home_directory_is_that_of_whoever_reads(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("HOME", "/home/me")
    axes = read(tmp_path, "axes: {stimuli: [~/photos, $HOME/more]}").axes
    assert axes["stimuli"] == ["/home/me/photos", "/home/me/more"]


@pytest.mark.parametrize("text", ["2024", "1e5", "true", "/a #1", "/b: c", "/end "])
def test_a_sweep_keeps_texts_as_they_are(tmp_path: Path, text: str) -> None:
    options = {"eye_plant.stimuli.cache_directory": text, "profile": text}
    sweep = Sweep(options, {"seed": [1]}, text)
    assert read(tmp_path, sweep.text()) == sweep


def test_every_option_is_one_of_run_experiment(tmp_path: Path) -> None:
    known = {word for action in parser()._actions for word in action.option_strings}
    assert {f"--{name}" for name in OPTIONS.values()} <= known


@pytest.mark.parametrize(
    ("text", "error"),
    [
        (
            "axes: {sead: [1]}",
            "axes: expected SECTION.NAME or one of .*'sead'; did you mean seed",
        ),
        ("options: {out: x}\naxes: {seed: [1]}", "options: expected SECTION.NAME .*'out'"),
        ("axes: {seed: []}", r"axes: seed: expected a list of values, got \[\]"),
        ("options: {seed: 1}", "axes: expected one at least"),
        ("options: {seed: 1}\naxes: {seed: [1]}", "seed: .* got it in options and seed"),
        (
            "axes: {profile: [a/b, a_b]}",
            "axes: expected a name of its own .* got profile_a_b twice",
        ),
        (
            "options: {model: M}\naxes: {seed: [{seed: 1, model: M_C}]}",
            "model: expected it in the options or in one axis, got it in options and seed",
        ),
        (
            "axes: {seed: [{seed: 1, model: M}], model: [M]}",
            "model: expected it in the options or in one axis, got it in seed and model",
        ),
        (
            "axes: {seed: [1, {eye_plant.stimuli.seed: 2}]}",
            "axes: seed: expected seed among what each entry sets, got {'eye_plant.stimuli.seed'",
        ),
        (
            "axes: {seed: [{seed: 1, modle: M}]}",
            "axes: seed: expected SECTION.NAME or one of .*'modle'; did you mean model",
        ),
        (
            "axes: {seed: [1], seed: [2]}",
            "expected a sweep as YAML: line 1: expected each key once",
        ),
        ("axes: {seed: [008]}", "expected a sweep as YAML: expected a number without leading zer"),
        (
            f"axes: {{stimuli: [/{250 * 'x'}]}}",
            "axes: expected names of runs up to 251 characters, got 259: stimuli_",
        ),
        ("axis: {seed: [1]}", "expected description, options, axes, got 'axis'"),
        ("axes: [seed]", "axes: expected names and values"),
        ("- axes", "expected a sweep with axes, got list"),
        ("axes: {seed: [1]", "expected a sweep as YAML"),
        ("axes: {lambda: [low]}", "lambda_low: lambda: expected a number, got 'low'"),
        ("axes: {model: [M, X]}", "model_X: model: expected M or M_C, got 'X'"),
    ],
)
def test_bad_files_are_one_error_that_names_the_file(tmp_path: Path, text: str, error: str) -> None:
    with pytest.raises(InputError, match=rf"sweep\.yaml: {error}"):
        read(tmp_path, text)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.yaml: expected a sweep as YAML"):
        read_sweep(tmp_path / "nowhere.yaml")


@pytest.mark.parametrize("path", sorted(SWEEPS.rglob("*.yaml")), ids=lambda path: path.stem)
def test_the_sweeps_behind_the_results_can_be_read(path: Path) -> None:
    assert read_sweep(path).description
