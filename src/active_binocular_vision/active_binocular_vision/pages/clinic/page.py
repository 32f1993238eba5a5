"""The page of the clinic: conditions at birth, before a change and at the end."""

import io
import sys
from collections.abc import Sequence
from contextlib import redirect_stderr
from pathlib import Path

import matplotlib as mpl

from active_binocular_vision.figures.treatments import clinic_figure
from active_binocular_vision.pages.clinic.examining import examined_run
from active_binocular_vision.pages.clinic.rows import Range, Row, rows_of
from active_binocular_vision.pages.clinic.treatments import courses_of, treatments_figure
from active_binocular_vision.pages.rearing.page import finished_runs
from active_binocular_vision.pages.report import page as report_page
from active_binocular_vision.runs.examined_run import AGES, ExaminedRun
from active_binocular_vision.runs.groups import common_of
from active_binocular_vision.runs.one_a_core import of_each_run
from active_binocular_vision.runs.reported_run import FIGURES
from experiment_manager.measures.tables import number
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.run.described_run import DescribedRun
from lockstep import InputError
from lockstep.durable_files import replace_file
from lockstep.figures import STYLE, save

CLINIC_FILE = "clinic.html"

# Name of the column, measure, factor, digits behind the point.
_COLUMNS = (
    ("horizontal / PD", "horizontal_deviation_pd", 1.0, 1),
    ("vertical / PD", "vertical_deviation_pd", 1.0, 1),
    ("fused / %", "share_fused", 100.0, 0),
    ("within 1 px / %", "share_within_1_px", 100.0, 0),
    ("acuity left / (cycles/deg)", "left_acuity_cycles_per_deg", 1.0, 2),
    ("right", "right_acuity_cycles_per_deg", 1.0, 2),
    ("stereo / arcsec", "stereo_threshold_arcsec", 1.0, 0),
    ("left eye in code / %", "left_share_in_code", 100.0, 0),
    ("binocular coarse / %", "binocular_share_coarse", 100.0, 0),
    ("fine / %", "binocular_share_fine", 100.0, 0),
    ("C / W", "metabolic_rate_w", 1.0, 3),
)
_ABOUT = (
    "Medians over seeds; in brackets the least and the greatest seed, and how many have a value if "
    "not all. Before: before the first change of the schedule. Horizontal, vertical: deviation of "
    "the covered right eye at 2 m, above 0 where it is turned in, or higher; the eyes begin at "
    "rest. Fused: share of the covers after which the eyes fuse again within 20 iterations. Within "
    "1 px and C: of the run's own test, after 20 iterations. Binocular: of the Gabor functions. "
    "docs/clinic.md defines all columns."
)
_CAPTION = (
    "A row for each condition. Marks: medians over seeds at birth, before the first change of the "
    "schedule, and at the end; lines: from the least to the greatest seed. No mark: no such test, "
    "or no value."
)

_TREATMENTS_CAPTION = (
    "A row for each treatment that began at several ages. Diamonds: medians over seeds at the end; "
    "lines: from the least to the greatest seed. Circles: right before the treatment. Dotted: at "
    "the end, without a treatment, where such runs are among those of the page."
)


def write_clinic_page(directories: Sequence[Path], out: Path) -> Path:
    """Write clinic.html and its figures into out; return the page's path.

    directories: of runs, and of sweeps, which stand for their finished runs. Each run gets its
    clinic.json. What cannot be examined is left out, with a line on standard error. Raises
    InputError, with the first reason, when nothing is left.
    """
    examined, reasons = _examined(directories)
    if not examined:
        raise InputError(reasons[0])
    for reason in reasons:
        print(f"left out: {reason}", file=sys.stderr)
    rows = rows_of(list(examined.values()), common_of([_described(run) for run in examined]))
    with mpl.rc_context(STYLE):
        figure = clinic_figure(rows)
        save(figure, out / FIGURES / "clinic.png")
        parts = [
            report_page.heading("Conditions"),
            report_page.picture(figure, _CAPTION),
        ]
        if courses := courses_of(rows):
            figure = treatments_figure(courses)
            save(figure, out / FIGURES / "treatments.png")
            parts.append(report_page.picture(figure, _TREATMENTS_CAPTION))
        parts += [clinic_table(rows), report_page.paragraph(_ABOUT)]
    replace_file(out / CLINIC_FILE, report_page.page("Clinic", parts).encode())
    return out / CLINIC_FILE


def clinic_table(rows: Sequence[Row]) -> str:
    """Return the table: a line for each row and age."""
    header = ("condition", "seeds", "age", *(name for name, *_ in _COLUMNS))
    lines = []
    for row in rows:
        for when in AGES:
            n_seeds = sum(run.at(when) is not None for run in row.runs)
            if n_seeds:
                ranges = (row.over_seeds(when, measure) for _, measure, *_ in _COLUMNS)
                cells = (
                    _cell(found, n_seeds, factor, n_digits)
                    for found, (_, _, factor, n_digits) in zip(ranges, _COLUMNS, strict=True)
                )
                lines.append((row.name, str(n_seeds), when, *cells))
    return report_page.table(header, lines)


def _described(directory: Path) -> DescribedRun:
    return DescribedRun(directory, (directory / CONFIG_FILE).read_text(), str(directory))


def _examined(directories: Sequence[Path]) -> tuple[dict[Path, ExaminedRun], list[str]]:
    """Return the examined runs by their directories, and why others are left out."""
    found: list[Path] = []
    reasons = []
    for directory in directories:
        try:
            found += finished_runs(directory)
        except InputError as error:
            reasons.append(str(error))
    results = of_each_run(_examined_or_why, found, "examining") if found else []
    examined = {
        directory: result
        for directory, result in zip(found, results, strict=True)
        if isinstance(result, ExaminedRun)
    }
    return examined, reasons + [result for result in results if isinstance(result, str)]


def _examined_or_why(directory: Path) -> ExaminedRun | str:
    try:
        # Each examination has a progress bar of its own.
        with redirect_stderr(io.StringIO()):
            return examined_run(directory)
    except (InputError, OSError) as error:
        text = str(error)
        return text if str(directory) in text else f"{directory}: {text}"


def _cell(found: Range | None, n_seeds: int, factor: float, n_digits: int) -> str:
    if found is None:
        return "-"
    median, least, greatest = (number(factor * value, n_digits) for value in found[:3])
    notes = [f"{least} to {greatest}"] if found.n > 1 else []
    notes += [f"{found.n} of {n_seeds}"] if found.n < n_seeds else []
    return f"{median} ({'; '.join(notes)})" if notes else median
