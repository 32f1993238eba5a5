"""Figures and tables of runs whose muscles have commands of their own."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes

from active_binocular_vision import Run
from active_binocular_vision.figures.runs.activations import activations_figure
from active_binocular_vision.figures.runs.boxes import box_figure
from active_binocular_vision.figures.runs.errors import errors_figure
from active_binocular_vision.figures.runs.learning_curve import performance_figure
from active_binocular_vision.figures.runs.over_lambda import lambda_figure, over_lambda
from active_binocular_vision.pages.report.drawings import drawings
from active_binocular_vision.pages.report.tables import antagonist_rows, comparison_rows
from active_binocular_vision.runs.groups import Group, groups_of
from experiment_manager.measures.trials import ERROR_NAMES
from lockstep import ALL_MUSCLES, HORIZONTAL_RECTI, PAIR
from tests.active_binocular_vision.own_commands import N_ITERATIONS, write_run
from tests.readable import assert_readable


@pytest.fixture(scope="module", params=[HORIZONTAL_RECTI, ALL_MUSCLES])
def group(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Group:
    directory = write_run(tmp_path_factory.mktemp("runs") / "run", request.param)
    return groups_of([Run(directory)])[0]


def _median_line(axes: Axes) -> np.ndarray:
    return np.asarray(axes.lines[0].get_ydata())


def test_each_error_is_drawn_over_a_trial_and_over_training(group: Group) -> None:
    figure = errors_figure([group])
    during, over = figure.axes[:3], figure.axes[3:]
    for name, of_trial, of_training in zip(ERROR_NAMES, during, over, strict=True):
        errors_deg = np.abs(group.last_trials.column(name))
        joined, last = of_trial.lines[0], of_trial.lines[1]
        assert np.asarray(joined.get_xdata()).tolist() == [0, 1, 2, 3], "those before the gap"
        assert [label.get_text() for label in of_trial.get_xticklabels()][-1] == str(N_ITERATIONS)
        medians_deg = np.median(errors_deg[:, [0, 1, 2, 3, N_ITERATIONS]], axis=0)
        shown_deg = np.concatenate([np.asarray(line.get_ydata()) for line in (joined, last)])
        assert np.allclose(shown_deg, medians_deg)
        finals_deg = [np.abs(group.trials_at(n).column(name)[:, -1]) for n in (0, 1000)]
        assert np.allclose(_median_line(of_training), np.median(finals_deg, axis=1))


def test_each_commanded_muscle_has_its_medians_and_how_often_it_is_active(group: Group) -> None:
    trials, silent = group.last_trials, group.last_criteria.silent_activation
    panels = activations_figure(group).axes[:3]
    shown_in: list[np.ndarray] = [
        np.ma.asarray(axes.images[0].get_array()).filled(0.0) for axes in panels
    ]
    start, end, active = shown_in
    for i_muscle, name in enumerate(trials.space.names):
        for i_distance, distance_m in enumerate((0.5, 3.0, 6.0)):
            values = trials.column(name)[trials.object_distance_m == distance_m]
            for shown, iteration in ((start, 0), (end, -1)):
                median = np.median(values[:, iteration])
                expected = median if median > silent else 0.0
                assert shown[i_muscle, i_distance] == pytest.approx(expected)
            share = 100.0 * np.mean(values[:, -1] > silent)
            assert active[i_muscle, i_distance] == pytest.approx(share)


def test_what_k17_published_of_the_pair_is_not_shown_beside_other_eyes(group: Group) -> None:
    for figure in (box_figure([group]), performance_figure([group])):
        assert not [text for text in figure.legends[0].get_texts() if "K17" in text.get_text()]


def test_figures_of_own_commands_can_be_read(group: Group) -> None:
    assert_readable(errors_figure([group]))
    assert_readable(activations_figure(group))


def test_prices_show_the_errors_about_all_axes(tmp_path: Path) -> None:
    family = [
        Run(write_run(tmp_path / f"{weight}", ALL_MUSCLES, "M_C", weight))
        for weight in (0.1, 0.3, 1.0)
    ]
    groups = over_lambda(groups_of(family))
    figure = lambda_figure(groups)
    assert_readable(figure)
    error, _, _ = figure.axes
    drawn = [np.asarray(line.get_ydata()) for line in error.lines[::2]]
    for medians, name in zip(drawn, ERROR_NAMES, strict=False):
        expected = np.median(np.abs(groups[0].last_trials.column(name)[:, -1]))
        assert np.allclose(medians, expected)
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels[:3] == ["horizontal (vergence)", "vertical", "torsional (cyclovergence)"]
    assert labels[3].startswith("n = 1 seed, ")


def test_a_row_for_each_two_antagonists(group: Group) -> None:
    rows = antagonist_rows([group])
    assert [*rows[0]][-3:] == ["at 0.5 m", "at 3 m", "at 6 m"]
    *rows, monkey = rows
    assert len(rows) == len(group.last_trials.space.names) // 2
    assert monkey["slope of lesser over greater"] == "-0.87, -1.15"
    assert rows[0]["eye"] == "left"
    assert rows[0]["antagonists"] == "medial rectus and lateral rectus"
    both = [group.last_trials.column(f"left_{m}_rectus")[:, -1] for m in ("medial", "lateral")]
    assert rows[0]["lesser activation"] == f"{np.median(np.minimum(*both)):.3f}"


def _columns(groups: list[Group]) -> tuple[list[str], dict[str, list[str]]]:
    rows = comparison_rows(groups)
    return [*rows[0]], {name: cells for name, *cells in map(dict.values, rows)}


def test_the_paper_stands_beside_the_pair_alone(group: Group, tmp_path: Path) -> None:
    header, cells = _columns([group])
    assert header == ["measure", "ours, M"]
    assert "our test set: median |vertical error| / deg" in cells
    assert not [name for name in cells if "2 deg" in name]

    pair = Run(write_run(tmp_path / "pair", PAIR))
    of_pair, of_others = sorted(groups_of([pair, *group.runs]), key=lambda g: not g.is_of_pair)
    header, cells = _columns([of_others, of_pair])
    assert [name.partition(",")[0] for name in header] == ["measure", "ours", "paper", "ours"]
    assert cells["starts up to 2 deg: median |vergence error| / deg"][:2] == ["-", "0.07"]
    assert cells["our test set: median |vertical error| / deg"][1:] == ["-", "-"]
    assert not [name for name in _columns([of_pair])[1] if "vertical" in name]


def test_the_plane_of_two_activations_is_left_out(group: Group) -> None:
    found = {drawing.name: drawing for drawing in drawings([group])}
    assert found["motor_space"].draw() is None
    assert found["motor_space"].left_out == ["run"]
    assert {"errors", "activations_0_M"} < set(found)
