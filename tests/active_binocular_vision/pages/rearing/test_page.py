"""The page of conditions, from a run and from runs whose every basis function is known."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.patches import StepPatch

import experiment_manager
from active_binocular_vision.commands.report import main
from active_binocular_vision.examinations.landscape import RewardLandscape
from active_binocular_vision.figures.rearing import (
    curves_figure,
    histograms_figure,
    landscapes_figure,
    samples_figure,
)
from active_binocular_vision.learners.basis_functions import tuning
from active_binocular_vision.pages.rearing.measuring import scale_tuning
from active_binocular_vision.pages.rearing.page import condition_table, finished_runs, left_out
from active_binocular_vision.runs.reared_run import (
    RearedRun,
    read_measures,
    run_measures,
    write_measures,
)
from experiment_manager.measures.results import Results
from lockstep import InputError
from sparse_coder.patches import PX_PER_PIXEL
from tests.active_binocular_vision.learners.gabor_patch import gabor_patch
from tests.experiment_manager.summaries import summary
from tests.readable import assert_readable

ERRORS_DEG = np.array([-1.0, 0.0, 1.0])


def atoms(right_eyes_share):
    """Four unit atoms of four orientations, the right eye's half so much weaker or stronger."""
    lefts = [gabor_patch(wave_angle_deg=angle) for angle in (0.0, 45.0, 90.0, -45.0)]
    both = np.stack([np.concatenate([left, right_eyes_share * left]) for left in lefts])
    return both / np.linalg.norm(both, axis=1, keepdims=True)


def reared(
    condition="normal",
    error_deg=0.1,
    *,
    right_eyes_share=1.0,
    model="M",
    seed=1,
    changed_at=(),
    within_1_px=0.25,
    samples=None,
):
    both = np.stack([atoms(right_eyes_share)] * 2).astype(np.float32)
    test = summary(
        iteration=0,
        median_abs_vergence_error_deg=2.0,
        iqr_abs_vergence_error_deg=1.0,
        share_within_1_px=within_1_px,
        median_cost_reduction=0.5,
        median_delta_cost_w=1.25,
    )
    last = replace(test, iteration=2000, median_abs_vergence_error_deg=error_deg)
    valley = np.array([[0.3, 0.3], [0.1, 0.1], [0.3, 0.3]])
    return RearedRun(
        directory=Path("run"),
        condition=condition,
        results=Results(
            model=model,
            profile="",
            seed=seed,
            iterations=2000,
            commit="",
            metabolic_cost_weight=0.0,
            cost_share_first=None,
            cost_share_last=None,
            tests=(test, last),
        ),
        scales=tuple(
            scale_tuning(tuning(both[i].astype(float), px), np.full(4, 0.25), 257.34)
            for i, px in enumerate(PX_PER_PIXEL)
        ),
        samples=both if samples is None else samples,
        landscape=RewardLandscape(ERRORS_DEG, valley, 0.5, np.full((2, 4), 0.25)),
        focal_length_px=257.34,
        changed_at=changed_at,
    )


def test_a_row_is_the_mean_over_seeds_beside_the_published_number():
    runs = [reared(error_deg=0.1), reared(error_deg=0.3, right_eyes_share=0.0, seed=2)]
    cells = re.findall(r"<td>(.*?)</td>", condition_table([("normal", runs)]))
    assert cells[:6] == ["normal", "2", "2,000", "0.20", "1.00", "0.25"]
    # Mean 7/15, least 0.2: 1 - 3/7; all atoms are Gabor functions, half of them binocular.
    assert cells[6:10] == ["0.57", "100 %, 100 %", "100 %, 100 %", "100 %, 100 %"]
    assert cells[10:14] == ["50 %, 50 %", "0.50", "0.50", "1.25"]
    assert "0.12 +- 0.17 deg" in cells[14]


def test_a_measure_of_no_trials_is_left_open():
    run = reared(within_1_px=None)
    cells = re.findall(r"<td>(.*?)</td>", condition_table([("normal", [run])]))
    assert cells[3:6] == ["0.10", "1.00", "-"]


def test_a_condition_that_nobody_has_published_has_no_number_beside_it():
    cells = re.findall(r"<td>(.*?)</td>", condition_table([("patching", [reared("patching")])]))
    assert cells[-1] == ""


def test_each_condition_has_a_panel_or_a_row_of_its_name():
    conditions = [(name, [reared(name), reared(name, seed=2)]) for name in ("vertical", "own_one")]
    for draw in (curves_figure, landscapes_figure):
        titles = [axes.get_title("left") for axes in draw(conditions).axes]
        assert [title.partition("  ")[2] for title in titles] == ["vertical stripes", "own one"]
    samples = samples_figure(conditions)
    assert samples is not None
    for figure, n_columns in ((samples, 2), (histograms_figure(conditions), 3)):
        rows = figure.axes[::n_columns]
        assert [axes.get_ylabel() for axes in rows[:2]] == ["vertical\nstripes", "own one"]


def test_the_figures_of_all_conditions_can_be_read():
    profiles = Path(experiment_manager.__file__).parent / "profiles" / "rearing"
    names = ["normal", *(path.stem for path in sorted(profiles.glob("*.yaml")))][:16]
    conditions = [(name, [reared(name)]) for name in dict.fromkeys(names)]
    for draw in (curves_figure, landscapes_figure, samples_figure, histograms_figure):
        figure = draw(conditions)
        assert figure is not None
        assert_readable(figure)


def test_each_seed_has_a_curve_before_those_of_normal_eyes():
    normal = [reared(error_deg=0.1)]
    changed = [reared("other", error_deg=0.3), reared("other", error_deg=0.5, seed=2)]
    first, second = curves_figure([("normal", normal), ("other", changed)]).axes
    assert [np.asarray(line.get_ydata())[-1] for line in first.lines[:1]] == [0.1]
    assert [np.asarray(line.get_ydata())[-1] for line in second.lines[:3]] == [0.1, 0.3, 0.5]
    assert list(np.asarray(second.lines[0].get_xdata())) == [0, 2000]


def test_normal_eyes_of_the_same_model_are_drawn_beside_a_condition():
    conditions = [
        (f"{name}, {model}", [reared(name, error_deg, model=model)])
        for model, errors_deg in (("M", (0.1, 0.3)), ("M_C", (0.2, 0.4)))
        for name, error_deg in zip(("normal", "other"), errors_deg, strict=True)
    ]
    curves = [axes.lines[:2] for axes in curves_figure(conditions).axes]
    ends = [[np.asarray(line.get_ydata())[-1] for line in lines] for lines in curves]
    assert [of_panel[0] for of_panel in ends] == [0.1, 0.1, 0.2, 0.2]
    assert [ends[1], ends[3]] == [[0.1, 0.3], [0.2, 0.4]]
    # Beside the line at an error of 0.
    n_lines = [len(axes.lines) for axes in landscapes_figure(conditions).axes]
    assert n_lines == [2, 3, 2, 3]


def test_landscapes_are_shares_of_their_mean_so_that_a_low_one_is_not_flat():
    low, high = reared("low"), reared("high")
    low.landscape.reconstruction_error[:] /= 10.0
    for axes in landscapes_figure([("low", [low]), ("high", [high])]).axes:
        # 0.6, 0.2 and 0.6 of a mean of 7/15.
        assert axes.lines[0].get_ydata() == pytest.approx([9 / 7, 3 / 7, 9 / 7])
        assert axes.texts[0].get_text() == "0.57"


def test_a_change_of_the_plant_is_marked():
    axes = curves_figure([("surgery", [reared(changed_at=(1000,))])]).axes[0]
    assert any(np.array_equal(line.get_xdata(), [1000, 1000]) for line in axes.lines)


def test_histograms_are_shares_of_those_that_count():
    orientation, binocularity, disparity = histograms_figure([("normal", [reared()] * 2)]).axes
    for outline in orientation.findobj(StepPatch):
        # Four orientations, 45 deg apart.
        assert outline.get_data()[0] == pytest.approx([25.0, 0.0] * 4)
    for outline in binocularity.findobj(StepPatch):
        assert outline.get_data()[0].sum() == pytest.approx(100.0)
    assert orientation.get_title(loc="right") == "n = 8 and 8"
    assert disparity.get_xlim() == (-4.0, 4.0)


def test_the_command_makes_the_page_of_a_run(small_run, tmp_path, capsys):
    assert main([str(small_run), "--rearing", "--out", str(tmp_path)]) == 0
    path = Path(capsys.readouterr().out.strip())
    assert path == tmp_path / "rearing.html"
    assert path.read_text().count("<img ") == 4
    assert "<td>paper</td>" in path.read_text()
    assert len(list((tmp_path / "figures").glob("rearing_*.png"))) == 4
    (measures,) = json.loads((tmp_path / "rearing.json").read_text())["runs"]
    assert measures["run"] == small_run.name
    assert measures["condition"] == "paper"


def test_measures_of_a_run_are_for_programs_to_read():
    measures = run_measures(reared(right_eyes_share=0.0, seed=2))
    assert (measures["condition"], measures["model"], measures["seed"]) == ("normal", "M", 2)
    assert measures["landscape"]["vergence_error_deg"] == [-1.0, 0.0, 1.0]
    assert measures["landscape"]["reconstruction_error_coarse"] == [0.3, 0.1, 0.3]
    assert measures["landscape"]["depth"] == pytest.approx(4 / 7, abs=1e-6)
    for scale in ("coarse", "fine"):
        # Four orientations, 45 deg apart; all atoms the left eye's, so that none tells a disparity.
        assert measures[scale]["orientation_counts"] == [1, 0] * 4
        assert measures[scale]["binocularity_counts"] == [4, 0, 0, 0, 0, 0, 0]
        assert measures[scale]["preferred_disparities_deg"] == []


def test_what_is_undefined_is_null_in_the_file_and_read_back(tmp_path):
    run = reared()
    run.landscape.reconstruction_error[0] = np.nan
    write_measures(tmp_path / "rearing.json", [run])
    (measures,) = json.loads((tmp_path / "rearing.json").read_text())["runs"]
    assert measures["landscape"]["reconstruction_error_fine"] == [None, 0.1, 0.3]
    assert measures["landscape"]["depth"] == pytest.approx(0.5)
    found = read_measures(tmp_path / "rearing.json", "run")
    assert found is not None
    landscape, scales = found
    assert np.isnan(landscape.reconstruction_error[0]).all()
    assert landscape.depth == pytest.approx(run.landscape.depth)
    assert scales[0].gabor_share == 1.0
    assert read_measures(tmp_path / "rearing.json", "other") is None


def test_vergence_errors_without_a_place_in_the_landscape_are_named():
    whole, broken = reared("normal"), reared("weak")
    broken.landscape.reconstruction_error[[0, 2]] = np.nan
    assert left_out([("normal", [whole])]) == ""
    assert left_out([("normal", [whole]), ("weak", [reared("weak"), broken])]).endswith(
        "elsewhere with them: weak at -1, 1 deg."
    )


def test_a_sweep_stands_for_its_finished_runs_in_its_order(tmp_path):
    (tmp_path / "sweep.yaml").write_text("axes: {seed: [2, 3, 1], profile: [paper]}")
    with pytest.raises(InputError, match="expected a sweep with a finished run"):
        finished_runs(tmp_path)
    first, unfinished, last = (tmp_path / f"seed_{i}-profile_paper" for i in (2, 3, 1))
    for run in (first, unfinished, last, tmp_path / "logs"):
        run.mkdir()
    for run in (first, last):
        (run / "results.json").touch()
    assert finished_runs(tmp_path) == [first, last]
    assert finished_runs(last) == [last]


def test_a_run_without_a_checkpoint_needs_its_line_in_the_file(small_run, tmp_path, capsys):
    run = tmp_path / small_run.name
    shutil.copytree(small_run, run, ignore=shutil.ignore_patterns("bag", "checkpoints"))
    assert main([str(run), "--rearing"]) == 2
    assert "expected a checkpoint, or the run in ../rearing.json" in capsys.readouterr().err
    assert main([str(small_run), "--rearing", "--out", str(tmp_path)]) == 0
    (measured,) = json.loads((tmp_path / "rearing.json").read_text())["runs"]
    shutil.rmtree(tmp_path / "figures")
    assert main([str(run), "--rearing", "--out", str(tmp_path)]) == 0
    (read,) = json.loads((tmp_path / "rearing.json").read_text())["runs"]
    # The depth follows from errors that the file has with six decimals.
    assert read["landscape"].pop("depth") == pytest.approx(
        measured["landscape"].pop("depth"), rel=1e-3
    )
    assert read == measured
    names = {path.stem for path in (tmp_path / "figures").iterdir()}
    assert names == {f"rearing_{name}" for name in ("curves", "landscapes", "histograms")}
    (tmp_path / "rearing.json").write_text('{"runs": [{}]}')
    assert main([str(run), "--rearing"]) == 2
    assert "expected the measures of runs" in capsys.readouterr().err
