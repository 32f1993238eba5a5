"""The command line of run_experiment.sh: one effective configuration, or one clear error."""

import re
from pathlib import Path

import pytest
import yaml

from active_binocular_vision.commands.command_line import arguments
from active_binocular_vision.commands.run import main as run_experiment
from experiment_manager.plant_changes import read_schedule
from experiment_manager.preparation.controls import CONTROLS
from experiment_manager.run.config_file import configuration_text, read_configuration
from experiment_manager.sections import CONFIG_CLASSES, DEFAULTS, config_of
from lockstep import InputError
from lockstep.task import DEFAULT_METABOLIC_COST_WEIGHTS
from tests.command_lines import configured


def test_the_papers_profile_is_the_defaults() -> None:
    manager = DEFAULTS["experiment_manager"] | {"commit": "0123abc", "profile": "paper"}
    assert configured("--profile", "paper") == DEFAULTS | {"experiment_manager": manager}


def test_a_model_or_a_number_of_iterations_asks_for_the_paper() -> None:
    demonstration = configured()
    assert demonstration["experiment_manager"]["profile"] == "demonstration"
    for line in (("--model", "M"), ("--iterations", "1000000")):
        assert configured(*line) == configured("--profile", "paper") != demonstration


def test_the_demonstration_differs_in_named_settings_alone() -> None:
    paper, demonstration = configured("--profile", "paper"), configured()
    differing = {
        f"{node}.{name}"
        for node, values in paper.items()
        for name, value in values.items()
        if demonstration[node][name] != value
    }
    assert {
        "task.n_training_iterations",
        "experiment_manager.test_iterations",
    } <= differing
    # What the plant is and what the coder learns with stay the paper's.
    assert not any(name.startswith("eyes.mechanics") for name in differing)
    assert demonstration["experiment_manager"]["n_stimuli_per_test"] >= 8


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ((), 0.08),
        (("--profile", "demonstration", "--model", "M"), 0.0),
        (("--model", "M"), 0.0),
        (("--model", "M_C"), DEFAULT_METABOLIC_COST_WEIGHTS["k17"]),
        (
            ("--model", "M_C", "--set", "eyes.mechanics.parameter_set=anatomical"),
            DEFAULT_METABOLIC_COST_WEIGHTS["anatomical"],
        ),
        (("--model", "M_C", "--set", "task.metabolic_cost_weight=0.05"), 0.05),
        (("--model", "M_C", "--lambda", "0.035"), 0.035),
        (("--model", "M", "--lambda", "0"), 0.0),
    ],
)
def test_the_default_of_lambda(line: tuple[str, ...], expected: float) -> None:
    assert configured(*line)["task"]["metabolic_cost_weight"] == expected


def test_the_seed_goes_to_all_who_draw_and_not_to_the_stimuli() -> None:
    one, two = configured("--seed", "1"), configured("--seed", "2")
    for config_class in CONFIG_CLASSES.values():
        assert [config_of(config_class, each).seed for each in (one, two)] == [1, 2]
    assert one["eye_plant"] == two["eye_plant"]


def test_a_directory_of_pictures_gives_the_numbers(pictures: Path) -> None:
    configuration = configured("--stimuli", str(pictures))
    manager = configuration["experiment_manager"]
    assert configuration["eye_plant"]["stimuli.directory"] == str(pictures.resolve())
    assert manager["n_training_stimuli"] == 3
    assert manager["n_test_stimuli"] == manager["n_stimuli_per_test"] == 2


@pytest.mark.parametrize(
    ("setting", "expected"),
    [
        ("task.n_training_iterations=1e6", 1_000_000),
        ("vergence_rl.cacla.discount=1e-5", 1e-5),
        ("task.lowest_activations=[1e-3, 0]", [0.001, 0.0]),
        ("eyes.camera.left_occluded=true", True),
        ('experiment_manager.run_id="2024"', "2024"),
        ("experiment_manager.run_id=2024-01-01", "2024-01-01"),
    ],
)
def test_values_are_read_as_yaml_1_2(setting: str, expected: object) -> None:
    section, _, name = setting.partition("=")[0].partition(".")
    assert configured("--set", setting, "--tests", "0")[section][name] == expected


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("--iterations", "15"), "--iterations 15: expected a multiple of 10"),
        (("--iterations", "0"), "--iterations 0: expected 1 or more, got 0"),
        (("--tests", "5"), "--tests 5: expected multiples of 10, got [5]"),
        (
            ("--seed", str(2**63)),
            "--seed 9223372036854775808: expected a whole number from -9223372036854775808 to",
        ),
        (("--set", "task.n_bases=0"), "--set task.n_bases=0: expected 1 or more, got 0"),
        (
            ("--set", "experiment_manager.gap_s=0"),
            "--set experiment_manager.gap_s=0: expected more than 0 s",
        ),
        (
            ("--iterations", "1000", "--tests", "0,5000"),
            "--tests 0,5000: expected training iterations up to 1000, the end of training, got",
        ),
        (
            ("--test-stimuli", "4000"),
            "--test-stimuli 4000: expected 40 or less, the number of test stimuli",
        ),
        (
            ("--model", "M", "--lambda", "0.03"),
            "--lambda 0.03: expected 0 with model M, whose reward counts no energy, got 0.03;",
        ),
        (
            ("--iterations", "500", "--set", "task.n_training_iterations=1000"),
            "--iterations 500 and --set task.n_training_iterations=1000: expected one",
        ),
        (
            ("--set", "experiment_manager.n_training_stimuli=50"),
            "--set experiment_manager.n_training_stimuli=50: expected 100, as eye_plant",
        ),
        (
            ("--set", "vergence_rl.cacla.discont=0.5"),
            "expected a setting, got 'vergence_rl.cacla.discont'; did you mean ",
        ),
        (("--set", "eyes.width_px=9"), "did you mean eyes.camera.width_px"),
        (
            ("--set", "task.seed=008"),
            "--set task.seed=008: expected a number without",
        ),
        (
            ("--set", "vergence_rl.cacla.discount=.nan"),
            "discount=.nan: expected 0 or more, less than 1",
        ),
        (("--set", "vergence.discount=1"), "got 'vergence.discount'; did you mean vergence_rl?"),
        (
            ("--set", "vergence_rl.cacla.discount=[1"),
            "--set vergence_rl.cacla.discount=[1: expected YAML",
        ),
        (
            ("--set", "vergence=1"),
            "--set: expected SECTION.NAME with a section of task",
        ),
        (("--lambda", "nan"), "--lambda nan: expected 0 or more"),
        (
            ("--profile", "paper", "--schedule-delay", "20"),
            "--schedule-delay 20: expected a profile that has a schedule, and no other schedule",
        ),
        (
            ("--profile", "clinic/glasses", "--schedule-delay", "-20"),
            "--schedule-delay -20: expected 0 training iterations or more, got -20",
        ),
        (
            ("--profile", "precice"),
            "profile: expected a known name, got 'precice'; did you mean precise",
        ),
        (("--profile", "zzz"), "profile: expected one of ablation/*, clinic/*, constant/*, "),
        (("--stimuli", "/nowhere"), "stimuli.directory: expected a directory of images"),
        (
            ("--set", "vergence_rl.cacla.discount=0.5", "--set", "vergence_rl.cacla.discount=0.4"),
            "--set vergence_rl.cacla.discount=0.5 and --set vergence_rl.cacla.discount=0.4: "
            "expected one",
        ),
        (("--in-process", "--elsewhere", "eye_plant"), "--in-process: expected it without"),
        (("--extend", "10"), "--extend: expected it with --resume"),
        (("--model", "X"), "abv run: error: "),
        (("--iterations", "many"), "--iterations: "),
        (("--iterations", "1.5e0"), "--iterations: "),
        (("--iterations", "inf"), "--iterations: "),
        (("--tests", "0,x"), "--tests: "),
        (("--what",), "--what"),
        (("--iter", "5"), "--iter"),
        (("--elsewhere", "experiment_manager"), "--elsewhere: expected one of eye_plant, sparse"),
        (("--elsewhere", "eye_plant,"), "--elsewhere: expected one of eye_plant, sparse_coder"),
    ],
)
def test_a_bad_command_line_is_one_clear_error(line, message, tmp_path, capsys) -> None:
    out = tmp_path / "run"
    try:
        code: object = run_experiment([*line, "--out", str(out)])
    except SystemExit as ended:  # what cannot be parsed
        code = ended.code
    assert code == 2
    (error,) = capsys.readouterr().err.splitlines()  # and no usage of all options
    assert "error: " in error
    assert message in error
    assert not out.exists()


def test_config_yaml_comes_back_as_it_was(tmp_path: Path) -> None:
    configuration = configured("--model", "M_C", "--seed", "7")
    path = tmp_path / "config.yaml"
    path.write_text(configuration_text(configuration))
    assert read_configuration(path) == configuration


def test_config_yaml_says_what_the_run_is() -> None:
    text = configuration_text(configured("--model", "M_C", "--seed", "7"))
    run = yaml.safe_load(text)["run"]["ros__parameters"]
    assert (run["model"], run["seed"], run["n_training_iterations"]) == ("M_C", 7, 1_000_000)
    assert (run["profile"], run["commit"]) == ("paper", "0123abc")
    assert any(version.startswith("mujoco ") for version in run["versions"])


@pytest.mark.parametrize(
    ("content", "message"),
    [
        *[
            (content, "config.yaml: expected the configuration of a run")
            for content in (b"", b"[]", b"{", b"a: 1", b"\x00", b"\xff", b"/**/eye_plant: {}")
        ],
        (b"/**/eye_plant: {ros__parameters: []}", "expected the configuration of a run"),
        (("  seed: 7", "  seed: 8"), "run.seed: expected 7, as the parameters have it, got 8"),
        (("  n_bases: 400", "  n_bases: 400\n    n_bases: 300"), "got 'n_bases' twice"),
        (("discount:", "discont:"), "config.yaml: unknown parameter cacla.discont"),
    ],
)
def test_what_is_no_config_yaml_is_refused(tmp_path, content, message) -> None:
    path = tmp_path / "config.yaml"
    if isinstance(content, tuple):
        text = configuration_text(configured("--seed", "7"))
        old, new = content
        content = text.replace(old, new, 1).encode()
    path.write_bytes(content)
    with pytest.raises(InputError, match=re.escape(message)):
        read_configuration(path)


def test_nodes_elsewhere() -> None:
    assert arguments([]).elsewhere == ()
    line = ["--elsewhere", "eye_plant,vergence_rl,eye_plant"]
    assert arguments(line).elsewhere == ("eye_plant", "vergence_rl")


def test_a_profile_s_schedule_may_be_put_off() -> None:
    line = ("--profile", "clinic/patching", "--schedule-delay", "2e4", "--tests", "0")
    schedule = read_schedule(configured(*line)["task"]["schedule"])
    assert [(change.at, change.settings) for change in schedule.changes] == [
        (25_000, {"eyes.camera.right_blur_px": 0.0}),
        (25_500, {"eyes.camera.left_occluded": True}),
        (28_000, {"eyes.camera.left_occluded": False}),
    ]


def test_each_control_withholds_something_and_none_nothing() -> None:
    plain = configured("--profile", "twelve")
    controlled = [configured("--profile", "twelve", "--control", name) for name in CONTROLS]
    assert plain not in controlled
    assert all(controlled.count(one) == 1 for one in controlled)
    with pytest.raises(InputError, match="--control starts_tonic: with command_space pair expect"):
        configured("--profile", "precise", "--control", "starts_tonic")
    with pytest.raises(InputError, match="starts_elsewhere: with command_space pair_and_lens "):
        configured("--profile", "triad", "--control", "starts_elsewhere")
