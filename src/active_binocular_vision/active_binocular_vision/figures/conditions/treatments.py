"""Until when a treatment helps: measures of each one over the age at which it began."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from active_binocular_vision.examinations.contract.measure import SHARE
from active_binocular_vision.figures.conditions.sheet import PERCENT_TICKS, heading_of, range_handle
from active_binocular_vision.figures.style import (
    BLUE,
    GREY,
    ORANGE,
    SKY,
    VERMILION,
    WIDTH_IN,
    legend_below,
    new_figure,
)
from active_binocular_vision.runs.conditions import NAMES, Column, Condition
from active_binocular_vision.runs.examined_run import BEFORE, END

# The condition that a treatment's profile begins with.
TREATED = {
    "surgery": "esotropia_10",
    "prisms": "esotropia_10",
    "glasses": "anisometropia_4",
    "patching": "anisometropia_4",
    "patching_half": "anisometropia_4",
}
# Of courses, in their order.
_COLOURS = (BLUE, VERMILION, SKY, ORANGE)
_END: dict[str, Any] = {"marker": "D", "ms": 4.0, "lw": 1.0}
_BEFORE: dict[str, Any] = {"marker": "o", "mfc": "w", "ms": 4.0, "ls": ""}
_UNTREATED: dict[str, Any] = {"lw": 1.0, "ls": ":"}
_MARGIN_SHARE = 0.2
_ROW_IN, _OTHER_IN = 1.15, 1.0
# Of life, between the marks of two courses at the same age.
_ASIDE_PERCENT = 4.0
_CODE = {True: "plastic", False: "frozen"}


@dataclass(frozen=True)
class Course:
    """A treatment at several ages, of learners that are otherwise alike.

    ages_percent: of training, rising, those of `conditions`; untreated: the same learners without
    it, if there are any.
    """

    treatment: str
    label: str
    ages_percent: tuple[float, ...]
    conditions: tuple[Condition, ...]
    untreated: Condition | None


def courses_of(conditions: Sequence[Condition]) -> list[Course]:
    """Return the treatments that began at two or more ages, in the order of their first conditions.

    Conditions of one age that differ in anything else, such as lambda, are in no course.
    """
    # By condition and learners, then by age.
    found: dict[tuple[Any, ...], dict[int | None, list[Condition]]] = {}
    for condition in conditions:
        run = condition.runs[0]
        kind = (run.condition, run.model, run.iterations, run.final_learning_rate)
        age = next(iter(run.changed_at), None)
        found.setdefault(kind, {}).setdefault(age, []).append(condition)
    courses = []
    for (treatment, *learners), by_age in found.items():
        ages = sorted(age for age, alike in by_age.items() if age is not None and len(alike) == 1)
        if treatment in TREATED and len(ages) > 1:
            model, iterations, final_learning_rate = learners
            untreated = found.get((TREATED[treatment], *learners), {}).get(None, [])
            courses.append(
                Course(
                    treatment=treatment,
                    label=f"{model}, {_CODE[final_learning_rate > 0]} dictionaries",
                    ages_percent=tuple(100.0 * age / iterations for age in ages),
                    conditions=tuple(by_age[age][0] for age in ages),
                    untreated=untreated[0] if len(untreated) == 1 else None,
                )
            )
    return courses


def treatments_figure(courses: Sequence[Course], columns: Sequence[Column]) -> Figure:
    """Return the measures over the age of treatment: medians over seeds, and their ranges.

    A row of panels for each treatment, a column for each measure.
    """
    treatments = list(dict.fromkeys(course.treatment for course in courses))
    labels = list(dict.fromkeys(course.label for course in courses))
    colours = dict(zip(labels, _COLOURS, strict=False))
    figure = new_figure(WIDTH_IN, _ROW_IN * len(treatments) + _OTHER_IN)
    shape = len(treatments), len(columns)
    grid = figure.subplots(*shape, sharex=True, sharey="col", squeeze=False)
    for course in courses:
        panels = grid[treatments.index(course.treatment)]
        aside = _ASIDE_PERCENT * (labels.index(course.label) - (len(labels) - 1) / 2.0)
        for axes, column in zip(panels, columns, strict=True):
            _draw(axes, course, column, aside, colours[course.label])
    for treatment, panels in zip(treatments, grid, strict=True):
        panels[0].set_ylabel(NAMES.get(treatment, treatment).replace(", ", ",\n"))
    for axes, column in zip(grid[0], columns, strict=True):
        axes.set_title(heading_of(column))
        if column.declared.unit == SHARE:
            margin = _MARGIN_SHARE * PERCENT_TICKS[-1]
            axes.set(yticks=PERCENT_TICKS, ylim=(-margin, PERCENT_TICKS[-1] + margin))
    for axes in grid[-1]:
        axes.set_xlabel("age\n% of training")
        axes.set_xlim(0.0, 100.0)
        axes.set_xticks(sorted({age for course in courses for age in course.ages_percent}))
    shown = [condition for course in courses for condition in course.conditions]
    legend_below(figure, [*_handles(colours), range_handle(shown)])
    return figure


def _draw(axes: Axes, course: Course, column: Column, aside: float, colour: str) -> None:
    """Draw a measure of a treatment: before it, at the end, and at the end without it."""
    ages = [age + aside for age in course.ages_percent]
    medians = []
    for age, condition in zip(ages, course.conditions, strict=True):
        end, before = (condition.over_seeds(when, column) for when in (END, BEFORE))
        medians.append(math.nan if end is None else end.median)
        if end is not None:
            axes.plot((age, age), (end.least, end.greatest), color=colour, lw=1.0)
        if before is not None:
            axes.plot(age, before.median, color=colour, **_BEFORE)
    axes.plot(ages, medians, color=colour, **_END)
    without = course.untreated and course.untreated.over_seeds(END, column)
    if without:
        axes.axhline(without.median, color=colour, **_UNTREATED)


def _handles(colours: Mapping[str, str]) -> list[Line2D]:
    """Return the lines of the legend."""
    named = (("end", _END), ("before the treatment", _BEFORE), ("end, untreated", _UNTREATED))
    courses = [Line2D([], [], color=colour, label=label) for label, colour in colours.items()]
    return courses + [Line2D([], [], color=GREY, label=label, **style) for label, style in named]
