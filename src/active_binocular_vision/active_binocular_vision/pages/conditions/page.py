"""The page of conditions: measures of tests and examinations, seeds pooled."""

import io
import sys
from collections.abc import Callable, Collection, Iterator, Sequence
from contextlib import redirect_stderr
from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from active_binocular_vision.figures.conditions.rearing import (
    curves_figure,
    histograms_figure,
    landscapes,
    landscapes_figure,
    samples_figure,
)
from active_binocular_vision.figures.conditions.sheet import MOST_COLUMNS, sheet_figure
from active_binocular_vision.figures.conditions.treatments import courses_of, treatments_figure
from active_binocular_vision.figures.style import own_style
from active_binocular_vision.pages import html
from active_binocular_vision.pages.conditions.published import PUBLISHED
from active_binocular_vision.pages.html import Drawing
from active_binocular_vision.runs.ages import AGES
from active_binocular_vision.runs.conditions import Column, Condition, conditions_of
from active_binocular_vision.runs.examined_run import TEST, ExaminedRun, examined_run
from active_binocular_vision.runs.groups import Common, common_of
from active_binocular_vision.runs.one_a_core import of_each_run
from active_binocular_vision.runs.results_folder import runs_with_tests
from active_binocular_vision.runs.run import Run
from lockstep import InputError
from lockstep.files.durable_files import replace_file

CONDITIONS_FILE = "conditions.html"

_ABOUT = (
    "Medians over seeds; in brackets the least and the greatest seed, and how many have a value if "
    "not all. Before: before the first change of the schedule. Test: the run's own, after the last "
    "iteration of a trial. In the cover test the eyes begin at rest and look at 2 m; deviations "
    "are those of the covered right eye, above 0 where it is turned in, or higher. "
    "docs/model/clinic.md and docs/model/rearing.md define all columns. Published: Klimmasch et "
    "al. (2021), after 500,000 iterations, mean and standard deviation."
)
_SHEET_CAPTION = (
    "A row for each condition, a colour for each model. Marks: medians over seeds at birth, before "
    "the first change of the schedule, and at the end; lines: from the least to the greatest seed. "
    "No mark: no such test, or no value."
)
_TREATMENTS_CAPTION = (
    "A row for each treatment that began at several ages. Diamonds: medians over seeds at the end; "
    "lines: from the least to the greatest seed. Circles: right before the treatment. Dotted: at "
    "the end, without a treatment, where such runs are among those of the page."
)
_UNREACHED = (
    "Left out, since no activations of the muscles give the vergence, or the eyes may rest "
    "elsewhere with them"
)
_Draw = Callable[[Sequence[Condition]], Figure | None]
# Of an examination: name, title, caption.
_FIGURES: tuple[tuple[str, str, str, str, _Draw], ...] = (
    (
        TEST,
        "curves",
        "Learning",
        "Median absolute vergence error after 20 iterations of test trials, over training, with the"
        " condition's own eyes and input; a line for each seed, grey for normal eyes. Dotted: 1 px."
        " Dashed: the schedule changes eyes or input.",
        curves_figure,
    ),
    (
        "landscape",
        "landscapes",
        "Landscape of the reward",
        "Reconstruction error E of both scales over the vergence error, divided by its mean, at the"
        " end of the run: ten test stimuli at 0.5, 2 and 6 m, mean over seeds. Grey: normal eyes."
        " The number is the depth, the share of the mean error that the best vergence saves.",
        landscapes_figure,
    ),
    (
        "tuning",
        "samples",
        "Basis functions",
        "Twelve of each scale's dictionary, from the best to the worst fit of a Gabor function to"
        " the dominant half: left eye's half (L) above the right eye's (R).",
        samples_figure,
    ),
    (
        "tuning",
        "histograms",
        "Tuning of the basis functions",
        "Shares of the n basis functions of the coarse and the fine scale that count, seeds pooled."
        " Orientation and binocularity: of those whose dominant half is a Gabor function."
        " Disparity: of those with one Gabor function common to both eyes that respond to both and"
        " are not near horizontal.",
        histograms_figure,
    ),
)


def write_conditions_page(
    directories: Sequence[Path],
    out: Path,
    columns: Sequence[Column],
    ages: Collection[str],
) -> Path:
    """Write conditions.html and its figures into out; return the page's path.

    directories: of runs, and of sweeps, which stand for their finished runs. Each run gets its
    examinations.json. What cannot be examined is left out, with a line on standard error. Raises
    InputError, with the first reason, when nothing is left.
    """
    runs, reasons = runs_with_tests(directories)
    names = sorted({column.examination for column in columns} - {TEST})
    work = partial(_examined_or_why, names, tuple(ages))
    unread = [run.unread() for run in runs]
    results = of_each_run(work, list(zip(unread, common_of(runs), strict=True)), "examining")
    reasons += [result for result in results if isinstance(result, str)]
    examined = [result for result in results if isinstance(result, ExaminedRun)]
    if not examined:
        raise InputError(reasons[0])
    for reason in reasons:
        print(f"left out: {reason}", file=sys.stderr)
    conditions = conditions_of(examined)
    with own_style():
        drawn = [part for of in drawings(conditions, columns) for part in of.parts(out)]
    table = html.section("Conditions", _ABOUT, condition_rows(conditions, columns))
    replace_file(out / CONDITIONS_FILE, html.page("Conditions", [*table, *drawn]).encode())
    return out / CONDITIONS_FILE


def _examined_or_why(
    names: Sequence[str], ages: Sequence[str], of: tuple[Run, Common]
) -> ExaminedRun | str:
    run, common = of
    try:
        # Each examination has a progress bar of its own.
        with redirect_stderr(io.StringIO()):
            return examined_run(run, common, names, ages)
    except (InputError, OSError) as error:
        text = str(error)
        return text if str(run.directory) in text else f"{run.directory}: {text}"


def condition_rows(
    conditions: Sequence[Condition], columns: Sequence[Column]
) -> list[dict[str, str]]:
    """Return a row of texts by heading for each condition and age."""
    headings = [column.heading for column in columns]
    rows = []
    for condition in conditions:
        published = PUBLISHED.get(condition.runs[0].condition, "")
        for age in AGES:
            n_seeds = sum(age in run.found for run in condition.runs)
            if n_seeds:
                row = {"condition": condition.name, "seeds": str(n_seeds), "age": age}
                for column, name in zip(columns, headings, strict=True):
                    other = f"{name}, {column.examination}.{column.measure}"
                    cell = column.cell(condition.over_seeds(age, column), n_seeds)
                    row[name if headings.count(name) == 1 else other] = cell
                rows.append(row | ({"published": published} if published else {}))
    return rows


def drawings(conditions: Sequence[Condition], columns: Sequence[Column]) -> Iterator[Drawing]:
    """Yield all columns, as many at once as fit beside one another, and more of examinations."""
    courses = courses_of(conditions)
    for i in range(0, len(columns), MOST_COLUMNS):
        some = columns[i : i + MOST_COLUMNS]
        number = f"_{1 + i // MOST_COLUMNS}" if i else ""
        yield Drawing(
            f"conditions{number}", "", _SHEET_CAPTION, partial(sheet_figure, conditions, some)
        )
        if courses:
            draw = partial(treatments_figure, courses, some)
            yield Drawing(f"treatments{number}", "", _TREATMENTS_CAPTION, draw)
    examined = {column.examination for column in columns}
    for examination, name, title, caption, draw_all in _FIGURES:
        if examination in examined:
            lack = (_UNREACHED, unreached(conditions)) if name == "landscapes" else ("", ())
            yield Drawing(name, title, caption, partial(draw_all, conditions), *lack)


def unreached(conditions: Sequence[Condition]) -> list[str]:
    """Name the vergence errors that landscapes do not have for want of activations."""
    missing = []
    for condition in conditions:
        of_seeds = landscapes(condition.runs)
        is_missing = np.isnan([total for _, total in of_seeds]).any(axis=0)
        if is_missing.any():
            errors_deg = " and ".join(f"{error_deg:g}" for error_deg in of_seeds[0][0][is_missing])
            missing.append(f"{condition.name} at {errors_deg} deg")
    return missing
