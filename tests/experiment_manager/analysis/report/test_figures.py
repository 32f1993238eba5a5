"""Figures show the numbers of the bag: what is drawn is read back from the axes."""

import copy
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.text import Text

from experiment_manager.anaglyph import anaglyph
from experiment_manager.analysis.report.condition_figures import conditions_figure
from experiment_manager.analysis.report.dictionary_figures import dictionary_figure
from experiment_manager.analysis.report.drawings import drawings
from experiment_manager.analysis.report.groups import groups_of
from experiment_manager.analysis.report.motor_space_figure import (
    MotorSpace,
    motor_space,
    motor_space_figure,
)
from experiment_manager.analysis.report.performance_figures import (
    box_figure,
    learning_curve,
    learning_curve_figure,
    performance_figure,
)
from experiment_manager.analysis.report.picture_figures import (
    anaglyph_figure,
    encoding_figure,
)
from experiment_manager.analysis.report.price_figure import over_prices, price_figure
from experiment_manager.analysis.report.reported_run import ReportedRun
from experiment_manager.measures.metrics import summary_of
from experiment_manager.measures.trials import Trials
from eye_plant.inverse.pair import Inverse
from eye_plant.mechanics.model import MechanicsConfig
from lockstep.errors import InputError
from sparse_coder.patches import PX_PER_PIXEL
from tests.readable import assert_readable, drawn_texts


def _is_inside(text: Text, figure: Figure) -> bool:
    extent = text.get_window_extent()
    return figure.bbox.x0 <= extent.x0 and extent.x1 <= figure.bbox.x1


def test_long_names_of_groups_are_not_cut_off(runs: list[ReportedRun]) -> None:
    groups = [
        replace(group, label=f"{group.label}, {'a long setting 0.123456789, ' * 4}")
        for group in groups_of(runs)
    ]
    grid = np.linspace(0, 0.1, 3)
    space = MotorSpace(2 * grid, grid, np.eye(3), np.eye(3), 0.056)
    for figure in (
        performance_figure(groups),
        box_figure(groups),
        motor_space_figure(space, groups),
    ):
        figure.draw_without_rendering()
        assert all(_is_inside(text, figure) for text in figure.legends[0].get_texts())
    figure = conditions_figure(groups)
    titles = [text for text in drawn_texts(figure) if "long setting" in text.get_text()]
    left, right = (title.get_window_extent() for title in titles)
    assert left.x1 < right.x0


@pytest.mark.filterwarnings("error:constrained_layout")
@pytest.mark.parametrize("drawn", [performance_figure, box_figure])
def test_a_long_legend_leaves_a_figure_its_height(drawn, runs) -> None:
    groups = [
        replace(groups_of(runs)[0], label=f"{i}, {'a long setting 0.123456789, ' * 2}")
        for i in range(40)
    ]
    few, many = drawn(groups[:1]), drawn(groups)
    for figure in (few, many):
        figure.draw_without_rendering()
    heights = [figure.axes[0].get_window_extent().height for figure in (few, many)]
    assert heights[1] > 0.7 * heights[0]


def test_fig_2_shows_the_medians_of_the_tests(runs: list[ReportedRun]) -> None:
    errors, deltas = performance_figure(groups_of(runs)).axes
    shown = zip(_points(errors), _points(deltas), runs, strict=True)
    for (at, medians_deg), (_, medians_w), run in shown:
        # Points of two models stand beside each other.
        assert np.allclose(at, [0, 130, 270, 400], atol=4)
        assert np.allclose(
            medians_deg,
            [np.median(np.abs(t.vergence_error_deg[:, 20])) for t in run.trials.values()],
        )
        tests = run.trials.values()
        assert np.allclose(medians_w, [np.median(test.delta_cost_w(20)) for test in tests])
    assert errors.get_yscale() == "log"
    assert "deg" in errors.get_ylabel()
    assert "W" in deltas.get_ylabel()


def _points(axes: Axes) -> list[tuple[np.ndarray, np.ndarray]]:
    """The points of all tests, (n,) iterations and values, that no line joins."""
    lines = [line for line in axes.lines if line.get_linestyle() == "None"]
    return [(np.asarray(line.get_xdata()), np.asarray(line.get_ydata())) for line in lines]


def test_training_is_drawn_behind_the_tests_of_a_run(runs: list[ReportedRun]) -> None:
    errors, deltas = learning_curve_figure(runs[0]).axes
    assert runs[0].recorded is not None
    curve = runs[0].recorded.measured.training_curve
    for axes, quartiles in ((errors, curve.quartiles_deg), (deltas, curve.quartiles_w)):
        assert np.array_equal(axes.lines[0].get_xdata(), curve.iteration)
        assert np.array_equal(axes.lines[0].get_ydata(), quartiles[1])


def test_fig_3_has_a_box_per_model_and_iteration(runs: list[ReportedRun]) -> None:
    figure = box_figure(groups_of(runs))
    upper, lower = figure.axes
    assert upper.get_yscale() == "log"
    medians = sorted(
        float(np.asarray(line.get_ydata())[0])
        for line in upper.lines
        if line.get_color() == "black"
    )
    expected = sorted(
        float(np.median(np.abs(run.trials[400].vergence_error_deg[:, k])))
        for run in runs
        for k in (1, 2, 3, 20)
    )
    assert np.allclose(medians, expected)
    assert [text.get_text() for text in lower.get_xticklabels()] == ["1", "2", "3", "20"]
    assert "%" in lower.get_ylabel()


def test_the_learning_curve_is_a_picture_in_the_run(run_directories: dict[str, Path]) -> None:
    path = learning_curve(run_directories["M"])
    assert path == run_directories["M"] / "figures" / "learning_curve.png"
    assert path.read_bytes().startswith(b"\x89PNG")


def test_the_motor_space_is_that_of_the_plant() -> None:
    config = MechanicsConfig()
    space = motor_space(config, n_medial=3, n_lateral=2)
    assert space.medial.tolist() == [0.0, 0.1, 0.2]
    assert space.lateral.tolist() == [0.0, 0.1]
    inverse = Inverse(config)
    expected = [[inverse.vergence_deg(m, a) for a in space.lateral] for m in space.medial]
    assert np.allclose(space.vergence_deg, expected, atol=1e-6)
    # OpenEyeSim's map as a power law, both eyes: 2 (2.229 A_MR^0.6 + 2.030 A_LR^0.6) W.
    law_w = 2 * (2.229 * 0.2**0.6 + 2.03 * 0.1**0.6)
    assert space.metabolic_rate_w[2, 1] == pytest.approx(law_w, rel=0.02)


def test_fig_4_draws_each_trial_to_its_end(runs: list[ReportedRun]) -> None:
    grid = np.linspace(0, 0.1, 11)
    medial, lateral = np.meshgrid(2 * grid, grid, indexing="ij")
    vergence_deg = 2 * (0.498 + 37.7 * medial - 40.9 * lateral)
    space = MotorSpace(2 * grid, grid, vergence_deg, medial + lateral, 0.056)
    figure = motor_space_figure(space, groups_of(runs))
    near, far = figure.axes[:2]
    # At 0.5 m there are trials from -3, -1, 1, 3 deg; at 6 m only from -3 and -1.
    for axes, distance_m, starts_deg in ((near, 0.5, (-3, -1, 1, 3)), (far, 6.0, (-3, -1))):
        paths = [line for line in axes.lines if len(np.asarray(line.get_xdata())) == 21]
        assert len(paths) == 2 * len(starts_deg)
        trials = runs[0].trials[400]
        for path, start_deg in zip(paths, starts_deg, strict=False):
            (i_trial,) = np.flatnonzero(
                (trials.object_distance_m == distance_m)
                & (np.abs(trials.vergence_error_deg[:, 0] - start_deg) < 1e-6)
            )
            found = np.stack([path.get_ydata(), path.get_xdata()], axis=1)
            assert np.array_equal(found, runs[0].trials[400].activations[i_trial])
    assert near.get_title("left").endswith("object at 0.5 m, 4 trials of each model")
    assert far.get_title("left").endswith("object at 6 m, 2 trials of each model")


def test_conditions_show_the_median_of_their_trials(runs: list[ReportedRun]) -> None:
    figure = conditions_figure(groups_of(runs))
    axes = figure.axes[0]
    mask = np.ma.getmaskarray(np.ma.asarray(axes.images[0].get_array()))
    assert mask.shape == (7, 10)
    assert (~mask).sum() == 39
    trials = runs[0].trials[400]
    start_deg = np.round(trials.vergence_error_deg[:, 0])
    here = (trials.object_distance_m == 2.0) & (start_deg == -1.0)
    expected = np.median(np.abs(trials.vergence_error_deg[here, -1]))
    row = [label.get_text() for label in axes.get_yticklabels()].index("2")
    column = [label.get_text() for label in axes.get_xticklabels()].index("-1")
    values = np.asarray(axes.images[0].get_array())
    assert values[row, column] == pytest.approx(expected)
    assert f"{expected:.2f}" in {text.get_text() for text in axes.texts}


def test_encoding_is_binned_by_vergence_error(runs: list[ReportedRun]) -> None:
    figure = encoding_figure(groups_of(runs[:1]))
    assert figure is not None
    (axes,) = figure.axes
    before, after = (np.asarray(line.get_ydata()) for line in axes.lines[:2])
    at_deg = np.asarray(axes.lines[1].get_xdata())
    assert runs[0].recorded is not None
    test = runs[0].recorded.tests[-1]
    here = np.abs(test.trials.vergence_error_deg[:, :20]) < 0.125
    expected = np.median(test.reconstruction_error[:, :20][here])
    assert after[at_deg == 0.0] == pytest.approx(expected)
    # The fixture encodes better the less the error, once it has learned.
    assert after[at_deg == 0.0] < np.nanmin(before) - 0.1


def test_there_is_no_encoding_of_too_few_observations(runs, monkeypatch) -> None:
    monkeypatch.setattr("experiment_manager.analysis.report.picture_figures._LEAST_PER_BIN", 10**6)
    assert encoding_figure(groups_of(runs)) is None


def test_an_anaglyph_is_red_for_the_left_eye_and_cyan_for_the_right() -> None:
    left, right = np.full((2, 3), 200, np.uint8), np.full((2, 3), 10, np.uint8)
    assert anaglyph(left, right)[1, 2].tolist() == [200, 10, 10]


def test_anaglyphs_show_a_trial_before_and_after_learning(runs: list[ReportedRun]) -> None:
    run = runs[0].recorded
    assert run is not None
    figure = anaglyph_figure(run)
    assert figure is not None
    # Trials 0, 10, 20, 30 have pictures; the last two start without error. Of the others the
    # lower median is the one that ends nearer.
    final_deg = np.abs(run.tests[-1].trials.vergence_error_deg[:, -1])
    trial = min((0, 10), key=lambda number: final_deg[number])
    for axes, test, iteration in zip(
        figure.axes, (run.tests[0],) * 2 + (run.tests[-1],) * 2, (0, 19, 0, 19), strict=True
    ):
        stamp_ns = int(test.stamps_ns[trial, iteration])
        ((_, left),) = run.bag.images("left/image_raw", [stamp_ns])
        ((_, right),) = run.bag.images("right/image_raw", [stamp_ns])
        shown = np.asarray(axes.images[0].get_array())
        assert np.array_equal(shown, anaglyph(left, right))
        error_deg = test.trials.vergence_error_deg[trial, iteration]
        px_deg = math.degrees(math.atan(1 / 257.34))
        assert f"error {error_deg:+.2f} deg ({error_deg / px_deg:+.1f} px)" in axes.get_title(
            "left"
        )


def test_both_scales_show_the_atoms_that_prefer_a_disparity_first() -> None:
    atoms = _gabor_atoms([2.0, None, -1.0, 0.5])
    figure = dictionary_figure(np.stack([atoms, atoms]))
    for axes in figure.axes[:2]:
        mosaic = np.asarray(axes.images[0].get_array())
        for i, shown in enumerate((2, 3, 0, 1)):
            left = mosaic[1:9, 19 * i + 2 : 19 * i + 10]
            expected = atoms[shown, :64].reshape(8, 8) / np.abs(atoms[shown]).max()
            np.testing.assert_allclose(left, expected)
    for histogram, px_per_pixel in zip(figure.axes[2:], PX_PER_PIXEL, strict=True):
        assert "3 of them prefer a disparity" in histogram.get_title("left")
        boxes = [bar.get_window_extent() for bar in histogram.patches]
        middles_px = [box.x0 + box.width / 2.0 for box in boxes if box.height]
        pixels = [(x, 0.0) for x in middles_px]
        middles = histogram.transData.inverted().transform(pixels)[:, 0]
        np.testing.assert_allclose(np.divide(middles, px_per_pixel), [-1.0, 0.5, 2.0], atol=0.15)


def _gabor_atoms(shifts_px: Sequence[float | None]) -> np.ndarray:
    """Atoms (n, 128) whose left half is the right one, its wave moved to the right; None: alone."""
    y, x = np.mgrid[-3.5:4.0, -3.5:4.0]
    envelope = np.exp(-(x**2 + y**2) / 6)
    right = envelope * np.cos(2 * np.pi * 0.12 * x + 0.4)
    atoms = []
    for shift_px in shifts_px:
        left = envelope * np.cos(2 * np.pi * 0.12 * (x - (shift_px or 0.0)) + 0.4)
        other = right if shift_px is not None else 0.0 * right
        atoms.append(np.concatenate([left.ravel(), other.ravel()]))
    return np.array(atoms)


def test_each_atom_becomes_one_tile() -> None:
    atoms = np.zeros((2, 20, 128), np.float32)
    atoms[0, 7, :64] = 2.0
    figure = dictionary_figure(atoms)
    mosaic = np.asarray(figure.axes[0].images[0].get_array())
    assert mosaic.shape == (2 * 9 + 1, 16 * 19 + 1)
    # None prefers anything, and what only one eye sees comes last: the fourth of the second row.
    first = 3 * 19 + 2
    assert (mosaic[10:18, first : first + 8] == 1.0).all(), "the left eye's part"
    assert (mosaic[10:18, first + 8 : first + 16] == 0.0).all(), "the right eye's"
    assert (mosaic[1:9, 2:18] == 0.0).all()
    with pytest.raises(InputError, match=r"expected atoms \(2, n_bases, 128\), got shape \(3, 4\)"):
        dictionary_figure(np.zeros((3, 4)))


def test_pictures_that_were_not_recorded_are_no_figure(runs, monkeypatch) -> None:
    run = runs[1].recorded
    assert run is not None
    monkeypatch.setattr(run.bag, "has", lambda topic: False)
    assert anaglyph_figure(run) is None


# --- several seeds, and prices


def _with_errors(test: Trials, errors_deg: np.ndarray) -> Trials:
    return replace(test, columns={**test.columns, "vergence_error_deg": errors_deg})


def _priced(run: ReportedRun, weight: float, error_factor: float) -> ReportedRun:
    """The same run as if it had another lambda and other errors, but for the start."""
    other = copy.copy(run)
    other.about = {**run.about, "metabolic_cost_weight": weight}
    factors = np.where(np.arange(21) > 0, error_factor, 1.0)
    other.trials = {
        at: _with_errors(test, test.vergence_error_deg * factors) for at, test in run.trials.items()
    }
    return other


def test_many_tests_are_joined_with_each_seed_thin_behind_the_pooled_median(
    runs: list[ReportedRun], monkeypatch: pytest.MonkeyPatch
) -> None:
    module = "experiment_manager.analysis.report.performance_figures"
    monkeypatch.setattr(f"{module}.LEAST_JOINED", 4)
    worse = _priced(runs[0], 0.0, 3.0)
    criteria = worse.evaluation_settings.criteria
    worse.summaries = tuple(summary_of(t, criteria(at)) for at, t in worse.trials.items())
    groups = groups_of([runs[0], worse])
    assert len(groups) == 1
    pooled, *seeds = performance_figure(groups).axes[0].lines[:3]
    finals_deg = [run.trials[400].vergence_error_deg[:, 20] for run in (runs[0], worse)]
    both = np.abs(np.concatenate(finals_deg))
    assert np.asarray(pooled.get_ydata())[-1] == pytest.approx(np.median(both))
    ends = [float(np.asarray(line.get_ydata())[-1]) for line in seeds]
    single = float(np.median(np.abs(runs[0].trials[400].vergence_error_deg[:, 20])))
    assert ends == pytest.approx([single, 3 * single])
    assert all(line.get_linewidth() < pooled.get_linewidth() for line in seeds)


@pytest.mark.parametrize("factor", [0.001, 1.0, 1.02])
def test_fig_2_always_has_two_labelled_ticks_below(runs: list[ReportedRun], factor: float) -> None:
    # Errors that hardly differ, far from any power of ten.
    flat = _priced(runs[0], 0.0, factor)
    flat.trials = {
        at: _with_errors(test, np.full((39, 21), 0.3 * factor)) for at, test in flat.trials.items()
    }
    lower = performance_figure(groups_of([flat])).axes[0]
    low, high = lower.get_ylim()
    labels = [t.get_text() for t in lower.get_yticklabels() if low <= t.get_position()[1] <= high]
    assert len([label for label in labels if label]) >= 2


def test_ends_of_both_models_in_one_point_can_be_told_apart(runs: list[ReportedRun]) -> None:
    grid = np.linspace(0, 0.1, 3)
    space = MotorSpace(2 * grid, grid, np.eye(3), np.eye(3), 0.056)
    near = motor_space_figure(space, groups_of(runs)).axes[0]
    ends = [line for line in near.lines if len(np.asarray(line.get_xdata())) == 1]
    looks = {(line.get_marker(), line.get_markersize(), line.get_color()) for line in ends}
    assert len(looks) == 2
    (below, *_), (above, *_) = (
        [line for line in ends if line.get_marker() == marker] for marker in ("o", "D")
    )
    assert below.get_markersize() > 1.5 * above.get_markersize()
    assert below.get_zorder() < above.get_zorder(), "the smaller one lies on the larger one"


def test_prices_are_compared_where_nothing_else_differs(runs: list[ReportedRun]) -> None:
    family = [_priced(runs[1], weight, factor) for weight, factor in ((0.2, 2), (0.01, 1))]
    assert over_prices(groups_of([runs[1], *family[:1]])) == [], "two prices are no curve"
    groups = over_prices(groups_of([*family, runs[1]]))
    assert [group.common.weight for group in groups] == [0.01, 0.08, 0.2]
    assert over_prices(groups_of([*runs, *family]))[0].model == "M", "without a price: lambda 0"
    figure = price_figure(groups)
    error, reduction, trade = figure.axes
    medians_deg = [
        np.median(np.abs(group.last_trials.vergence_error_deg[:, 20])) for group in groups
    ]
    assert np.allclose(error.lines[0].get_ydata(), medians_deg)
    assert np.allclose(error.lines[0].get_xdata(), [0.01, 0.08, 0.2])
    medians = [np.nanmedian(group.last_trials.cost_reduction(20)) for group in groups]
    assert np.allclose(reduction.lines[0].get_ydata(), 100 * np.array(medians))
    rates_w = [np.median(group.last_trials.metabolic_rate_w[:, 20]) for group in groups]
    assert np.allclose(trade.lines[0].get_xdata(), rates_w)
    assert np.allclose(trade.lines[0].get_ydata(), medians_deg)


def test_a_price_of_0_has_a_place_before_a_break(runs: list[ReportedRun]) -> None:
    family = [_priced(runs[1], weight, 1) for weight in (0.0, 0.03, 0.3)]
    error, *_ = price_figure(over_prices(groups_of(family))).axes
    assert np.asarray(error.lines[0].get_xdata()) == pytest.approx([0.01, 0.03, 0.3])
    assert [label.get_text() for label in error.get_xticklabels()] == ["0", "0.03", "0.1", "0.3"]
    assert "//" in {text.get_text() for text in error.texts}


def test_every_figure_of_a_report_can_be_read(runs: list[ReportedRun]) -> None:
    priced = [_priced(runs[1], weight, 1 + weight) for weight in (0.05, 0.1, 0.2)]
    found = {drawing.name: drawing.draw() for drawing in drawings(groups_of([*runs, *priced]))}
    figures = {name: figure for name, figure in found.items() if figure is not None}
    assert figures.keys() > {"performance", "boxes", "motor_space", "conditions", "encoding"}
    assert figures.keys() > {"price_of_energy"}
    for figure in figures.values():
        assert_readable(figure)
