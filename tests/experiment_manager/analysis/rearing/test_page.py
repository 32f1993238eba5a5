"""The page of conditions, from a run and from runs whose every basis function is known."""

import json
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from experiment_manager.analysis.basis_functions import tuning
from experiment_manager.analysis.rearing.figures import (
    curves_figure,
    histograms_figure,
    landscapes_figure,
    samples_figure,
)
from experiment_manager.analysis.rearing.measures_file import run_measures, write_measures
from experiment_manager.analysis.rearing.page import condition_table, finished_runs, left_out
from experiment_manager.analysis.rearing.reared_run import RearedRun
from experiment_manager.analysis.rearing.reward_landscape import RewardLandscape
from experiment_manager.commands.report import main
from experiment_manager.measures.results import Results
from lockstep.errors import InputError
from sparse_coder.patches import PX_PER_PIXEL
from tests.experiment_manager.analysis.gabor_patch import gabor_patch
from tests.experiment_manager.summaries import summary

ERRORS_DEG = np.array([-1.0, 0.0, 1.0])


def half(wave_angle_deg):
    return gabor_patch(
        wave_angle_deg=wave_angle_deg,
        wavelength_px=5.0,
        x_px=0.0,
        y_px=0.0,
        width_px=1.7,
        length_px=2.0,
        phase_rad=0.3,
    )


def atoms(right_eyes_share):
    """Four unit atoms of four orientations, the right eye's half so much weaker or stronger."""
    halves = [np.concatenate([half(a), right_eyes_share * half(a)]) for a in (0.0, 45.0, 90.0, -45)]
    return np.stack([h / np.linalg.norm(h) for h in halves])


def reared(
    condition="normal",
    error_deg=0.1,
    *,
    right_eyes_share=1.0,
    seed=1,
    changed_at=(),
    within_1_px=0.25,
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
            model="M",
            profile="",
            seed=seed,
            iterations=2000,
            commit="",
            metabolic_cost_weight=0.0,
            cost_share_first=None,
            cost_share_last=None,
            tests=(test, last),
        ),
        atoms=both,
        tunings=tuple(tuning(both[i].astype(float), px) for i, px in enumerate(PX_PER_PIXEL)),
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


@pytest.mark.parametrize("n_conditions", [1, 3])
def test_each_condition_has_a_line_or_a_row(n_conditions):
    conditions = [(f"condition {i}", [reared(), reared(seed=2)]) for i in range(n_conditions)]
    for draw in (curves_figure, landscapes_figure):
        (axes,) = draw(conditions).axes
        named = [line for line in axes.lines if not str(line.get_label()).startswith("_")]
        assert [line.get_label() for line in named] == [label for label, _ in conditions]
    assert len(samples_figure(conditions).axes) == 2 * n_conditions
    assert len(histograms_figure(conditions).axes) == 3 * n_conditions


def test_lines_show_means_over_seeds():
    conditions = [("normal", [reared(error_deg=0.1), reared(error_deg=0.3, seed=2)])]
    curve = curves_figure(conditions).axes[0].lines[0]
    assert list(np.asarray(curve.get_xdata())) == [0.0, 2.0]
    assert curve.get_ydata() == pytest.approx([2.0, 0.2])
    landscape = landscapes_figure(conditions).axes[0].lines[0]
    assert landscape.get_ydata() == pytest.approx([0.6, 0.2, 0.6])


def test_a_bar_across_the_curve_marks_a_change_of_the_plant():
    run = reared(error_deg=0.02, changed_at=(1000,))
    _, bars, *_ = curves_figure([("surgery", [run])]).axes[0].lines
    assert bars.get_marker() == "|"
    assert list(np.asarray(bars.get_xdata())) == [1.0]
    # Half-way from 2 to 0.02 deg on a logarithmic axis.
    assert bars.get_ydata() == pytest.approx([0.2])


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


def test_what_is_undefined_is_null_in_the_file(tmp_path):
    run = reared()
    run.landscape.reconstruction_error[0] = np.nan
    write_measures(tmp_path / "rearing.json", [run])
    (measures,) = json.loads((tmp_path / "rearing.json").read_text())["runs"]
    assert measures["landscape"]["reconstruction_error_fine"] == [None, 0.1, 0.3]
    assert measures["landscape"]["depth"] == pytest.approx(0.5)


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


def test_a_run_without_a_checkpoint_is_refused(small_run, tmp_path, capsys):
    run = tmp_path / "run"
    shutil.copytree(small_run, run, ignore=shutil.ignore_patterns("bag", "checkpoints"))
    assert main([str(run), "--rearing"]) == 2
    assert "expected a checkpoint, found none" in capsys.readouterr().err
