"""All figures of a report can be read."""

from dataclasses import replace

import numpy as np
import pytest
import yaml
from matplotlib.figure import Figure
from matplotlib.text import Text

from active_binocular_vision import Run, groups_of
from active_binocular_vision.figures.runs.boxes import box_figure
from active_binocular_vision.figures.runs.conditions import conditions_figure
from active_binocular_vision.figures.runs.learning_curve import (
    performance_figure,
)
from active_binocular_vision.figures.runs.motor_space import (
    MotorSpace,
    motor_space_figure,
)
from active_binocular_vision.figures.runs.pictures import encoding_figure
from active_binocular_vision.pages.report.drawings import drawings
from experiment_manager.plant_changes import read_schedule
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from tests.active_binocular_vision.changed_runs import priced
from tests.readable import assert_readable, drawn_texts


def _is_inside(text: Text, figure: Figure) -> bool:
    extent = text.get_window_extent()
    return figure.bbox.x0 <= extent.x0 and extent.x1 <= figure.bbox.x1


def test_long_names_of_groups_are_not_cut_off(runs: list[Run]) -> None:
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
    for of_panels in (conditions_figure(groups), encoding_figure(groups)):
        assert of_panels is not None
        texts = [text for text in drawn_texts(of_panels) if "long setting" in text.get_text()]
        # The titles come before the legend, if there is one.
        left, right = (title.get_window_extent() for title in texts[:2])
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


def test_the_motor_space_is_that_of_the_last_test(runs, monkeypatch) -> None:
    run = runs[0]
    turned_in = {"eyes.mechanics.rest_adduction_deg": [5.0, 5.0]}
    schedule = read_schedule(yaml.safe_dump([{"at": 200, "set": turned_in}]))
    run.evaluation_settings = replace(run.evaluation_settings, schedule=schedule)
    drawn: list[MechanicsConfig] = []
    monkeypatch.setattr(f"{drawings.__module__}.motor_space", drawn.append)
    monkeypatch.setattr(f"{drawings.__module__}.motor_space_figure", lambda *_: None)
    next(d for d in drawings(groups_of([run])) if d.name == "motor_space").draw()
    assert [mechanics.rest_adduction_deg for mechanics in drawn] == [(5.0, 5.0)]


def test_every_figure_of_a_report_can_be_read(runs: list[Run]) -> None:
    of_lambdas = [priced(runs[1], weight, 1 + weight) for weight in (0.05, 0.1, 0.2)]
    found = {drawing.name: drawing.draw() for drawing in drawings(groups_of([*runs, *of_lambdas]))}
    figures = {name: figure for name, figure in found.items() if figure is not None}
    assert figures.keys() > {"performance", "boxes", "motor_space", "conditions", "encoding"}
    assert figures.keys() > {"lambda"}
    for figure in figures.values():
        assert_readable(figure)
