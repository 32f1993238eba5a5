"""The command line of run_experiment.sh: one effective configuration, or one clear error."""

import re
from pathlib import Path

import pytest
import yaml

from active_binocular_vision.commands.command_line import arguments
from active_binocular_vision.commands.run_experiment import main as run_experiment
from experiment_manager.experiment.agreements import AGREEMENTS, by_key, check_agreements
from experiment_manager.experiment.plant_changes import read_schedule
from experiment_manager.run.config_file import (
    CONFIG_CLASSES,
    configuration_text,
    read_configuration,
)
from lockstep.configuration import flatten
from lockstep.errors import InputError
from sparse_coder.config import DEFAULT_METABOLIC_COST_WEIGHTS
from tests.command_lines import configured

_PROTOCOL = "experiment_manager.protocol"


def test_the_papers_profile_is_the_defaults() -> None:
    configuration = configured("--profile", "paper")
    for node, config_class in CONFIG_CLASSES.items():
        expected = flatten(config_class())
        if node == "experiment_manager":
            expected |= {"commit": "0123abc", "profile": "paper"}
        assert configuration[node] == expected


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
        "experiment_manager.protocol.n_training_iterations",
        "experiment_manager.protocol.test_iterations",
    } <= differing
    # What the plant is and what the coder learns with stay the paper's.
    assert not any(name.startswith("eye_plant.mechanics") for name in differing)
    assert demonstration["experiment_manager"]["protocol.n_stimuli_per_test"] >= 8


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ((), 0.05),
        (("--profile", "demonstration", "--model", "M"), 0.0),
        (("--model", "M"), 0.0),
        (("--model", "M_C"), DEFAULT_METABOLIC_COST_WEIGHTS["k17"]),
        (
            ("--model", "M_C", "--set", "eye_plant.mechanics.parameter_set=anatomical"),
            DEFAULT_METABOLIC_COST_WEIGHTS["anatomical"],
        ),
        (("--model", "M_C", "--set", "sparse_coder.metabolic_cost_weight=0.05"), 0.05),
        (("--model", "M_C", "--lambda", "0.035"), 0.035),
        (("--model", "M", "--lambda", "0"), 0.0),
    ],
)
def test_the_price_of_energy(line: tuple[str, ...], expected: float) -> None:
    configuration = configured(*line)
    assert configuration["sparse_coder"]["metabolic_cost_weight"] == expected
    assert configuration["experiment_manager"]["metabolic_cost_weight"] == expected


def test_the_seed_goes_to_all_who_draw_and_not_to_the_stimuli() -> None:
    one, two = configured("--seed", "1"), configured("--seed", "2")
    for node in ("sparse_coder", "vergence_rl", "experiment_manager"):
        assert (one[node]["seed"], two[node]["seed"]) == (1, 2)
    assert one["eye_plant"] == two["eye_plant"]


def test_a_directory_of_pictures_gives_the_numbers(pictures: Path) -> None:
    configuration = configured("--stimuli", str(pictures))
    manager = configuration["experiment_manager"]
    assert configuration["eye_plant"]["stimuli.directory"] == str(pictures.resolve())
    assert manager["protocol.n_training_stimuli"] == 3
    assert manager["protocol.n_test_stimuli"] == manager["protocol.n_stimuli_per_test"] == 2


def test_what_two_nodes_must_know_agrees_by_default() -> None:
    configuration = {n: flatten(c()) for n, c in CONFIG_CLASSES.items()}
    check_agreements(configuration)
    # Parameters that are not there are not asked.
    assert {key for a in AGREEMENTS for key in (a.first, a.second)} <= by_key(configuration).keys()


@pytest.mark.parametrize(
    ("setting", "partner"),
    [
        ("sparse_coder.n_bases=100", "vergence_rl.n_features=200"),
        ("vergence_rl.n_features=200", "sparse_coder.n_bases=100"),
        ("vergence_rl.lowest_activations=[0.01]", f"{_PROTOCOL}.lowest_activations=[0.01]"),
        (f"{_PROTOCOL}.highest_activations=[0.2]", "vergence_rl.highest_activations=[0.2]"),
        (f"{_PROTOCOL}.n_training_iterations=500", "vergence_rl.n_training_iterations=500"),
        ("vergence_rl.n_training_iterations=500", f"{_PROTOCOL}.n_training_iterations=500"),
        ("experiment_manager.mechanics.baseline_m=0.06", "eye_plant.mechanics.baseline_m=0.06"),
    ],
)
def test_what_two_nodes_must_know_is_said_to_either(setting: str, partner: str) -> None:
    one = configured("--set", setting, "--tests", "0")
    assert one == configured("--set", partner, "--tests", "0")
    assert one == configured("--set", setting, "--set", partner, "--tests", "0")
    (node, _, name), value = partner.partition("=")[0].partition("."), partner.partition("=")[2]
    assert one[node][name] == yaml.safe_load(value)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        (
            ("sparse_coder.n_bases=100", "vergence_rl.n_features=300"),
            "vergence_rl.n_features: expected 2 times sparse_coder.n_bases, which is 100, got 300",
        ),
        (
            ("vergence_rl.n_features=301",),
            "vergence_rl.n_features: expected 2 times sparse_coder.n_bases, got 301",
        ),
        (
            ("vergence_rl.n_training_iterations=500", f"{_PROTOCOL}.n_training_iterations=1000"),
            f"expected {_PROTOCOL}.n_training_iterations, which is 1000, got 500",
        ),
        (
            ("eye_plant.mechanics.baseline_m=0.06", "experiment_manager.mechanics.baseline_m=0.05"),
            "expected eye_plant.mechanics.baseline_m, which is 0.06, got 0.05",
        ),
    ],
)
def test_what_two_nodes_must_know_is_not_said_in_two_ways(settings, message) -> None:
    line = [word for setting in settings for word in ("--set", setting)]
    with pytest.raises(InputError, match=re.escape(message)):
        configured("--tests", "0", *line)


@pytest.mark.parametrize(
    ("line", "message"),
    [
        (("--iterations", "15"), "--iterations: expected a multiple of 10"),
        (("--iterations", "0"), "--iterations: expected 1 or more, got 0"),
        (("--tests", "5"), "--tests: expected multiples of 10, got [5]"),
        (
            ("--seed", str(2**63)),
            "--seed: expected a whole number from -9223372036854775808 to 9223372036854775807, got",
        ),
        (("--set", "sparse_coder.n_bases=0"), "sparse_coder: n_bases: expected 1 or more, got 0"),
        (("--set", "experiment_manager.gap_s=0"), "gap_s: expected more than 0 s, got 0.0"),
        (
            ("--iterations", "1000", "--tests", "0,5000"),
            "--tests 0,5000: expected training iterations up to 1000, the end of training, got",
        ),
        (
            ("--test-stimuli", "4000"),
            "--test-stimuli 4000: expected 40 or less, as many test stimuli there are",
        ),
        (
            ("--model", "M", "--lambda", "0.03"),
            "--lambda 0.03: expected 0 with model M, which has no price on energy, got 0.03; model",
        ),
        (
            ("--lambda-share", "0.2", "--model", "M"),
            "--lambda-share 0.2: expected model M_C, M has no price on energy",
        ),
        (
            ("--iterations", "500", "--set", f"{_PROTOCOL}.n_training_iterations=1000"),
            f"--iterations 500 and --set {_PROTOCOL}.n_training_iterations=1000: expected one",
        ),
        (
            ("--set", f"{_PROTOCOL}.n_training_stimuli=50"),
            f"--set {_PROTOCOL}.n_training_stimuli=50: expected 100, as eye_plant.stimuli has",
        ),
        (
            ("--set", "vergence_rl.cacla.discont=0.5"),
            "vergence_rl: unknown parameter cacla.discont: did you mean cacla.discount?",
        ),
        (("--set", "eye_plant.width_px=9"), "did you mean camera.width_px or "),
        (("--set", "vergence.discount=1"), "got 'vergence.discount=1'; did you mean vergence_rl?"),
        (
            ("--set", "vergence_rl.cacla.discount=[1"),
            "--set vergence_rl.cacla.discount=[1: expected a value",
        ),
        (("--set", "vergence=1"), "--set: expected NODE.PARAMETER=VALUE with a node of eye_plant"),
        (("--lambda", "nan"), "--lambda: expected 0 or more"),
        (
            ("--profile", "paper", "--schedule-delay", "20"),
            "--schedule-delay 20: expected a profile that has a schedule, and no other schedule",
        ),
        (
            ("--profile", "clinic/glasses", "--schedule-delay", "-20"),
            "--schedule-delay -20: expected 0 training iterations or more, got -20",
        ),
        (("--lambda-share", "1"), "--lambda-share 1: expected a share in [0, 1), got 1.0"),
        (
            ("--lambda-share", "0.2", "--lambda", "0.1"),
            "--lambda-share 0.2: expected it without --lambda 0.1, got both",
        ),
        (("--profile", "demo"), "profile: expected one of "),
        (("--stimuli", "/nowhere"), "stimuli.directory: expected a directory of pictures"),
    ],
)
def test_a_bad_command_line_is_one_clear_error(line: tuple[str, ...], message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        configured(*line)


@pytest.mark.parametrize(
    "line",
    [
        (),
        ("--profile", "precise_m_c"),
        ("--iterations", "500", "--set", "experiment_manager.model=M_C"),
    ],
)
def test_energy_may_have_a_share_however_the_model_is_chosen(line: tuple[str, ...]) -> None:
    assert configured("--lambda-share", "0.2", *line) == configured(*line)


@pytest.mark.parametrize(
    "words",
    [
        ["--model", "X"],
        ["--iterations", "many"],
        ["--iterations", "1.5e0"],
        ["--iterations", "inf"],
        ["--tests", "0,x"],
        ["--what"],
        ["--iter", "5"],
    ],
)
def test_what_cannot_be_parsed_exits_with_2(words, capsys) -> None:
    with pytest.raises(SystemExit) as exit_info:
        arguments(words)
    assert exit_info.value.code == 2
    (line,) = capsys.readouterr().err.splitlines()  # and no usage of all options
    assert line.startswith("run_experiment.sh: error: ")


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
    "content",
    [
        b"",
        b"[]",
        b"{",
        b"a: 1",
        b"\x00",
        b"\xff",
        b"/**/eye_plant: {}",
        b"/**/eye_plant: {ros__parameters: []}",
    ],
)
def test_what_is_no_config_yaml_is_refused(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "config.yaml"
    path.write_bytes(content)
    with pytest.raises(InputError, match=r"config\.yaml: expected the configuration of a run"):
        read_configuration(path)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("  seed: 7", "  seed: 8", "run.seed: expected 7, as experiment_manager has it, got 8"),
        ("n_features: 800", "n_features: 600", "vergence_rl.n_features: expected 2 times"),
    ],
)
def test_a_config_yaml_that_contradicts_itself_is_refused(tmp_path, old, new, message) -> None:
    path = tmp_path / "config.yaml"
    text = configuration_text(configured("--seed", "7"))
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(InputError, match=re.escape(message)):
        read_configuration(path)


def test_a_config_yaml_with_an_unknown_parameter_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "config.yaml"
    text = configuration_text(configured())
    path.write_text(text.replace("discount:", "discont:"))
    with pytest.raises(InputError, match=r"config\.yaml: unknown parameter cacla.discont"):
        read_configuration(path)


def test_nodes_elsewhere() -> None:
    assert arguments([]).elsewhere == ()
    line = ["--elsewhere", "eye_plant,vergence_rl,eye_plant"]
    assert arguments(line).elsewhere == ("eye_plant", "vergence_rl")


@pytest.mark.parametrize("text", ["experiment_manager", "eye_plant,", "plant"])
def test_who_cannot_be_elsewhere(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit):
        arguments(["--elsewhere", text])
    error = capsys.readouterr().err
    assert "--elsewhere: expected some of eye_plant, sparse_coder, vergence_rl, got " in error


def test_nodes_elsewhere_are_none_of_one_process(tmp_path, capsys) -> None:
    out = tmp_path / "run"
    assert run_experiment(["--in-process", "--elsewhere", "eye_plant", "--out", str(out)]) == 2
    error = "error: --in-process: expected it without --elsewhere, got both\n"
    assert capsys.readouterr().err == error
    assert not out.exists()


def test_a_profile_s_schedule_may_be_put_off() -> None:
    line = ("--profile", "clinic/patching", "--schedule-delay", "2e4", "--tests", "0")
    schedule = read_schedule(configured(*line)["experiment_manager"]["schedule"])
    assert [(change.at, change.settings) for change in schedule.changes] == [
        (25_000, {"eye_plant.camera.right_blur_px": 0.0}),
        (25_500, {"eye_plant.camera.left_occluded": True}),
        (28_000, {"eye_plant.camera.left_occluded": False}),
    ]
