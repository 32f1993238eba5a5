"""evaluate: the numbers of results.json follow from the bag, and a changed one is found."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from active_binocular_vision import Run
from active_binocular_vision.commands.evaluate import main
from experiment_manager import Bag
from experiment_manager.measures.results import write_document


@pytest.fixture
def run(run_directories: dict[str, Path]) -> Run:
    return Run(run_directories["M_C"])


def test_a_run_tells_what_it_is(run: Run) -> None:
    assert (run.name, run.model, run.seed, run.n_iterations) == ("M_C", "M_C", 1, 400)
    assert (run.metabolic_cost_weight, run.commit) == (0.08, "0123abc")
    assert run.versions == ("mujoco 4.0.0", "numpy 2.4.6")
    assert run.configuration["eyes"]["mechanics.baseline_m"] == 0.056


def test_the_tests_are_joined_by_stamp(run: Run) -> None:
    assert [test.trials.training_iteration for test in run.recorded.tests] == [0, 130, 270, 400]
    for test in run.recorded.tests:
        assert test.trials.activations.shape == (39, 21, 2)
        medial, lateral = (test.trials.column(f"{name}_rectus") for name in ("medial", "lateral"))
        # The fixture's own map from activations to cost, so each row is joined with its own.
        cost_w = 2 * (
            2.229 * np.maximum(medial, 0.005) ** 0.6 + 2.03 * np.maximum(lateral, 0.005) ** 0.6
        )
        assert np.allclose(cost_w, test.trials.metabolic_rate_w)
        assert np.isnan(test.reconstruction_error[:, 20]).all()
        assert np.isfinite(test.reconstruction_error[:, :20]).all()


def test_the_training_curve_is_of_episode_ends(run: Run) -> None:
    curve = run.recorded.training_curve
    # 40 episodes make 2 bins of 20; an episode's last observation is 10 iterations in.
    assert curve.iteration.tolist() == [105.0, 305.0]
    truth = Bag(run.directory / "bag").vectors("ground_truth")["ground_truth"]
    ends = (truth.column("phase") == 0) & (truth.column("iteration") == 10)
    errors_deg = np.abs(truth.column("vergence_error_deg")[ends]).reshape(2, 20)
    assert np.allclose(curve.quartiles_deg, np.quantile(errors_deg, (0.25, 0.5, 0.75), axis=1))


def test_the_share_of_the_cost_is_that_of_the_first_and_the_last_training_iterations(
    run, monkeypatch
) -> None:
    monkeypatch.setattr("active_binocular_vision.runs.recorded.SHARE_ITERATIONS", 100)
    tables = run.bag.vectors("reward", "ground_truth")
    truth, reward = tables["ground_truth"], tables["reward"]
    names = ("phase", "training_iteration")
    about = dict(
        zip(truth.stamps_ns.tolist(), zip(*map(truth.column, names), strict=True), strict=True)
    )
    sums = {"first": [0.0, 0.0], "last": [0.0, 0.0]}
    for stamp, row in zip(reward.stamps_ns.tolist(), reward.position, strict=True):
        phase, iteration = about[stamp]
        end = "first" if iteration < 100 else "last" if iteration >= 300 else ""
        if phase == 0 and end:
            sums[end][0] += row[0] + row[1]
            sums[end][1] += row[2]
    first, last = (0.08 * cost_w / (error + 0.08 * cost_w) for error, cost_w in sums.values())
    assert abs(first - last) > 0.001  # so that taking one for the other would be seen
    assert Run(run.directory).recorded.cost_shares == (
        pytest.approx(first),
        pytest.approx(last),
    )
    # As if the run had been interrupted an episode before its end.
    for n_share, expected in ((100, (pytest.approx(first), None)), (5000, (None, None))):
        monkeypatch.setattr("active_binocular_vision.runs.recorded.SHARE_ITERATIONS", n_share)
        interrupted = Run(run.directory)
        interrupted.about = {**interrupted.about, "n_training_iterations": 410}
        assert interrupted.recorded.cost_shares == expected


def test_results_from_the_bag_agree_with_themselves(run_directories, tmp_path, capsys) -> None:
    directory = Path(shutil.copytree(run_directories["M_C"], tmp_path / "run"))
    path = directory / "results.json"
    assert main([str(directory)]) == 0
    assert "There is no" in capsys.readouterr().out
    write_document(path, Run(directory).results_of_bag())
    assert main([str(directory)]) == 0
    assert f"of {path} follow from the bag" in capsys.readouterr().out
    document = json.loads(path.read_text())
    assert [test["iteration"] for test in document["tests"]] == [0, 130, 270, 400]

    document["tests"][1]["after_2"]["median_delta_cost_w"] *= 1.0001
    document["lambda_share"]["last_5000"] = None
    write_document(path, document)
    assert main([str(directory)]) == 1
    error = capsys.readouterr().err
    assert "different: tests[1].after_2.median_delta_cost_w: results.json has" in error
    assert "different: lambda_share.last_5000: results.json has None, the bag gives" in error
    assert error.count("different:") == 2


def test_what_is_no_run_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path)]) == 2
    assert capsys.readouterr().err == f"error: {tmp_path}: expected a run with config.yaml\n"


def test_a_configuration_that_cannot_be_read_is_one_line(
    run_directories: dict[str, Path], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    directory = Path(shutil.copytree(run_directories["M"], tmp_path / "run"))
    text = Run(directory).configuration_text
    for damaged, told in (
        ("[1", "expected the configuration of a run"),
        (text.replace("    camera.focal_length_px: 257.34\n", ""), "it lacks eyes.camera.focal"),
        (text.replace("    iterations_per_trial: 20\n", ""), "it lacks task.iterations_per_trial"),
    ):
        (directory / "config.yaml").write_text(damaged)
        assert main([str(directory)]) == 2
        error = capsys.readouterr().err
        assert error.startswith(f"error: {directory}: expected")
        assert told in error
