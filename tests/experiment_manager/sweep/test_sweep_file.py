"""What a sweep's file says, and what it may not say."""

from pathlib import Path

import pytest
import yaml

from active_binocular_vision.commands.command_line import parser
from experiment_manager.preparation.request import OPTIONS, RunRequest
from experiment_manager.run.config_file import Configuration
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
    cells = {cell.name: cell.request for cell in sweep.cells()}
    assert [*cells] == [
        "model_M-discount_0.3",
        "model_M-discount_1e-5",
        "model_M_C-discount_0.3",
        "model_M_C-discount_1e-5",
    ]
    request = cells["model_M_C-discount_1e-5"]
    assert (request.profile, request.iterations, request.model) == ("paper", 100_000, "M_C")
    assert request.overrides == {"task.n_bases": 32, "vergence_rl.cacla.discount": 1e-5}


def test_an_entry_may_set_several_together(tmp_path: Path) -> None:
    sweep = read(
        tmp_path,
        "axes:\n"
        "  seed: [{seed: 1, eye_plant.stimuli.seed: 101}, {eye_plant.stimuli.seed: 102, seed: 2}]\n"
        "  lambda: [0, {lambda: 0.1, model: M_C}]\n",
    )
    runs = {cell.name: cell.request for cell in sweep.cells()}
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
    assert read(tmp_path, sweep.text()) == sweep


def test_a_cell_is_the_run_of_its_command_line(tmp_path: Path, pictures: Path) -> None:
    entries: list[object] = [1, {"seed": 2, "eyes.camera.left_blur_px": 0.5}]
    sweep = read_sweep(write_sweep(tmp_path / "s.yaml", pictures, {"seed": entries}))
    lines = (
        command_line(pictures, seed=1),
        command_line(pictures, seed=2, **{"eyes.camera.left_blur_px": 0.5}),
    )
    for cell, line in zip(sweep.cells(), lines, strict=True):
        assert RunRequest.from_json(cell.request.to_json()) == cell.request
        assert cell.configuration("0123abc") == configured(*line)


def test_parameters_of_one_last_name_are_told_apart(tmp_path: Path) -> None:
    sweep = read(tmp_path, "axes: {task.seed: [1], task.seed: [2]}")
    assert [cell.name for cell in sweep.cells()] == ["sparse_coder.seed_1-vergence_rl.seed_2"]


def test_a_name_is_a_directory_whatever_its_values_are(tmp_path: Path) -> None:
    sweep = read(tmp_path, "axes: {tests: [[0, 10], [20]], profile: [rearing/aligned]}")
    assert [cell.name for cell in sweep.cells()] == [
        "tests_0_10-profile_rearing_aligned",
        "tests_20-profile_rearing_aligned",
    ]


def test_what_a_sweep_keeps_of_itself_reads_as_the_same(tmp_path: Path) -> None:
    sweep = read(tmp_path, "description: why\noptions: {seed: 3}\naxes: {lambda: [0.1, 1e-3]}")
    assert read(tmp_path, sweep.text()) == sweep
    assert yaml.safe_load(sweep.text())["description"] == "why"


@pytest.mark.parametrize("name", ["stimuli", "eye_plant.stimuli.directory"])
def test_directories_of_images_are_kept_absolute(tmp_path, monkeypatch, name) -> None:
    monkeypatch.chdir(tmp_path)
    on_axis = read(tmp_path, f"axes: {{{name}: [photos, '']}}")
    assert on_axis.axes[name] == [str(tmp_path / "photos"), ""]
    together = read(tmp_path, f"axes: {{seed: [{{seed: 1, {name}: photos}}]}}")
    assert together.axes["seed"] == [{"seed": 1, name: str(tmp_path / "photos")}]
    option = read(tmp_path, f"options: {{{name}: photos}}\naxes: {{seed: [1]}}")
    assert option.options[name] == str(tmp_path / "photos")


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
        ("axes: {seed: 3}", "axes: seed: expected a list of values, got 3"),
        ("options: {seed: 1}", "axes: expected one at least"),
        (
            "options: {seed: 1}\naxes: {seed: [1]}",
            "seed: expected it among the options or the axes",
        ),
        (
            "axes: {seed: [1, 2, 1]}",
            "axes: expected a name of its own for each run, got seed_1 twice",
        ),
        (
            "axes: {profile: [a/b, a_b]}",
            "axes: expected a name of its own .* got profile_a_b twice",
        ),
        (
            "options: {model: M}\naxes: {seed: [{seed: 1, model: M_C}]}",
            "model: expected it among the options or the axes",
        ),
        (
            "axes: {seed: [{seed: 1, model: M}], model: [M]}",
            "axes: model: expected one axis that sets it, got seed and model",
        ),
        (
            "axes: {seed: [1, {eye_plant.stimuli.seed: 2}]}",
            "axes: seed: expected seed among what each entry sets, got {'eye_plant.stimuli.seed'",
        ),
        (
            "axes: {seed: [{seed: 1, modle: M}]}",
            "axes: seed: expected SECTION.NAME or one of .*'modle'; did you mean model",
        ),
        ("axis: {seed: [1]}", "expected description, options, axes, got 'axis'"),
        ("axes: [seed]", "axes: expected names and values"),
        (
            "axes: {experiment_manager.run_id: [2024-01-01]}",
            "run_id_2024-01-01: experiment_manager.run_id: .*the date",
        ),
        ("- axes", "expected a sweep with axes, got list"),
        ("axes: {seed: [1]", "expected a sweep as YAML"),
    ],
)
def test_bad_files_are_one_error_that_names_the_file(tmp_path: Path, text: str, error: str) -> None:
    with pytest.raises(InputError, match=rf"sweep\.yaml: {error}"):
        read(tmp_path, text)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.yaml: expected a sweep as YAML"):
        read_sweep(tmp_path / "nowhere.yaml")


@pytest.mark.parametrize(
    ("axes", "error"),
    [
        ("model: [M, X]", "model_X: model: expected M or M_C, got 'X'"),
        ("seed: [1, one]", "seed_one: seed: expected a whole number, got 'one'"),
        ("model: [M], lambda: [0.1]", "model_M-lambda_0.1: lambda: expected 0 with model M"),
        ("lambda: [low]", "lambda_low: lambda: expected a number, got 'low'"),
        ("profile: [papre]", "profile_papre: profile: expected one of .* did you mean paper"),
        ("vergence_rl.cacla.discont: [0.1]", "discont_0.1: .*discount"),
        ("vergence_rl.cacla.discount: [2.0]", "discount_2.0: "),
    ],
)
def test_what_a_cell_cannot_be_is_said_with_its_name(tmp_path, pictures, axes, error) -> None:
    text = f"options: {{iterations: 100}}\naxes: {{{axes}}}"

    def last_configuration() -> Configuration:
        *_, last = read(tmp_path, text, pictures).cells()
        return last.configuration("")

    with pytest.raises(InputError, match=error):
        last_configuration()


# A life in the clinic, and a comparison of how soon vergence comes.
SHORT = ("clinic", "clinic_memory", "clinic_treatment", "clinic_untreated", "gaze_saliency")


@pytest.mark.parametrize("path", sorted(SWEEPS.rglob("*.yaml")), ids=lambda path: path.stem)
def test_the_sweeps_behind_the_results_can_be_read(path: Path) -> None:
    sweep = read_sweep(path)
    assert sweep.description
    least = 50_000 if path.stem in SHORT else 100_000
    for request in (cell.request for cell in sweep.cells()):
        if request.profile != "demonstration":  # which has its own length
            assert request.iterations is not None
            assert request.iterations >= least
