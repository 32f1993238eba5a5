"""The page of conditions: what became of eyes that were reared differently."""

from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

from active_binocular_vision.figures.rearing import (
    Condition,
    curves_figure,
    histograms_figure,
    landscapes_figure,
    samples_figure,
)
from active_binocular_vision.pages.rearing.conditions import PUBLISHED
from active_binocular_vision.pages.rearing.measuring import read_reared_run
from active_binocular_vision.pages.report import page as report_page
from active_binocular_vision.runs.one_a_core import of_each_run
from active_binocular_vision.runs.reared_run import (
    MEASURES_FILE,
    RearedRun,
    ScaleTuning,
    write_measures,
)
from active_binocular_vision.runs.reported_run import FIGURES
from experiment_manager.measures.results import RESULTS_FILE, Summary
from experiment_manager.measures.tables import number
from experiment_manager.sweep.sweep_file import SWEEP_FILE, read_sweep
from lockstep import InputError
from lockstep.durable_files import replace_file
from lockstep.figures import STYLE, save

REARING_FILE = "rearing.html"

_Figure = tuple[str, str, str, Callable[[Sequence[Condition]], Figure | None]]
_FIGURES: tuple[_Figure, ...] = (
    (
        "curves",
        "Learning",
        "Median absolute vergence error after 20 iterations of test trials, over training, with the"
        " condition's own eyes and input; a line for each seed, grey for normal eyes. Dotted: 1 px."
        " Dashed: the schedule changes eyes or input.",
        curves_figure,
    ),
    (
        "landscapes",
        "Landscape of the reward",
        "Reconstruction error E of both scales over the vergence error, divided by its mean, at the"
        " end of the run: ten test pictures at 0.5, 2 and 6 m, mean over seeds. Grey: normal eyes."
        " The number is the depth, the share of the mean error that the best vergence saves.",
        landscapes_figure,
    ),
    (
        "samples",
        "Basis functions",
        "Twelve of each scale's dictionary, from the best to the worst fit of a Gabor function to"
        " the dominant half: left eye's half (L) above the right eye's (R). Runs without a"
        " checkpoint are left out.",
        samples_figure,
    ),
    (
        "histograms",
        "Tuning of the basis functions",
        "Shares of the n basis functions of the coarse and the fine scale that count, seeds pooled."
        " Orientation and binocularity: of those whose dominant half is a Gabor function."
        " Disparity: of those with one Gabor function common to both eyes that respond to both and"
        " are not near horizontal.",
        histograms_figure,
    ),
)


def write_rearing_page(directories: Sequence[Path], out: Path) -> Path:
    """Write rearing.html, its figures and rearing.json into out; return the page's path.

    directories: of runs, and of sweeps, which stand for their finished runs. Runs of one profile
    and model are one condition, in the order given. Raises InputError for a directory that holds no
    finished run.
    """
    found = [run for directory in directories for run in finished_runs(directory)]
    runs = of_each_run(read_reared_run, found, "measuring")
    conditions = _conditions(runs)
    parts = [
        report_page.heading("Conditions"),
        condition_table(conditions),
        report_page.paragraph(
            "Error: median and interquartile range of |vergence error| after 20 iterations of the "
            "last test, in deg, and the share of trials within one pixel; with a camera rotated by "
            "3 deg pictures match at an error of 3 deg. Depth: 1 - least / mean reconstruction "
            "error over vergence. Gabor: coarse and fine basis functions whose dominant half is "
            "fitted by a Gabor function with at most 20 % of the squares of both halves left; by "
            "use: their share in the code of the landscape's pictures; common: those that one "
            "function for both eyes fits as well. Binocular: Gabor functions with "
            "|(R - L) / (R + L)| below 0.5. Left: the left eye's share of the code. c and delta C: "
            "energy saved (K17 eq. 8) and energy above the least, medians. Published: Klimmasch et "
            "al. (2021), after 500,000 iterations, mean and standard deviation."
        ),
    ]
    with mpl.rc_context(STYLE):
        for name, title, caption, draw in _FIGURES:
            figure = draw(conditions)
            if figure is None:
                continue
            save(figure, out / FIGURES / f"rearing_{name}.png")
            parts += [report_page.heading(title), report_page.picture(figure, caption)]
            if name == "landscapes" and (missing := left_out(conditions)):
                parts.append(report_page.paragraph(missing))
    write_measures(out / MEASURES_FILE, runs)
    replace_file(out / REARING_FILE, report_page.page("Altered rearing", parts).encode())
    return out / REARING_FILE


def finished_runs(directory: Path) -> list[Path]:
    """Return the directory of a run, or those of a sweep's finished runs in the sweep's order.

    Raises InputError for a sweep without any.
    """
    if not (directory / SWEEP_FILE).is_file():
        return [directory]
    cells = read_sweep(directory / SWEEP_FILE).cells()
    runs = [directory / cell.name for cell in cells]
    finished = [run for run in runs if (run / RESULTS_FILE).is_file()]
    if not finished:
        raise InputError(f"{directory}: expected a sweep with a finished run, found none")
    return finished


def _conditions(runs: Sequence[RearedRun]) -> list[Condition]:
    has_both = len({run.results.model for run in runs}) > 1
    by_label: dict[str, list[RearedRun]] = {}
    for run in runs:
        label = f"{run.condition}, {run.results.model}" if has_both else run.condition
        by_label.setdefault(label, []).append(run)
    return list(by_label.items())


def condition_table(conditions: Sequence[Condition]) -> str:
    """Return the table of conditions, means over seeds, beside the published numbers."""
    header = ["condition", "seeds", "iterations", "error", "IQR", "within 1 px", "depth", "Gabor"]
    header += ["by use", "common", "binocular", "left", "c", "delta C / W", "published"]
    return report_page.table(header, [_row(*condition) for condition in conditions])


def left_out(conditions: Sequence[Condition]) -> str:
    """Say which vergence errors a landscape does not have for want of a pair, "" for none."""
    missing = []
    for label, runs in conditions:
        landscapes = [run.landscape for run in runs]
        is_missing = np.isnan([landscape.total_error for landscape in landscapes]).any(axis=0)
        if is_missing.any():
            errors_deg = landscapes[0].vergence_error_deg[is_missing]
            missing.append(
                f"{label} at {', '.join(f'{error_deg:g}' for error_deg in errors_deg)} deg"
            )
    if not missing:
        return ""
    return (
        "Left out, since no activations of the muscles give the vergence, or the eyes may rest "
        f"elsewhere with them: {'; '.join(missing)}."
    )


def _row(label: str, runs: Sequence[RearedRun]) -> tuple[str, ...]:
    def of_test(measure: Callable[[Summary], float | None]) -> str:
        values = [v for run in runs if (v := measure(run.results.tests[-1])) is not None]
        return number(float(np.mean(values)), 2) if len(values) == len(runs) else "-"

    def of_scales(value: Callable[[ScaleTuning], float]) -> str:
        means = (np.mean([value(run.scales[i]) for run in runs]) for i in range(2))
        return ", ".join(f"{100.0 * mean:.0f} %" for mean in means)

    return (
        label,
        str(len(runs)),
        ", ".join(sorted({f"{run.results.iterations:,}" for run in runs})),
        of_test(lambda test: test.median_abs_vergence_error_deg),
        of_test(lambda test: test.iqr_abs_vergence_error_deg),
        of_test(lambda test: test.share_within_1_px),
        number(float(np.mean([run.landscape.depth for run in runs])), 2),
        of_scales(lambda tuning: tuning.gabor_share),
        of_scales(lambda tuning: tuning.gabor_share_by_use),
        of_scales(lambda tuning: tuning.common_gabor_share),
        of_scales(lambda tuning: tuning.binocular_share),
        number(float(np.mean([run.landscape.left_share for run in runs])), 2),
        of_test(lambda test: test.median_cost_reduction),
        of_test(lambda test: test.median_delta_cost_w),
        PUBLISHED.get(runs[0].condition, ""),
    )
