"""One self-contained report.html from the bags of one or more runs, beside the paper's numbers."""

import argparse
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import matplotlib as mpl
import numpy as np
import yaml
from matplotlib.figure import Figure

from experiment_manager.measures.recorded_run import RecordedRun
from experiment_manager.rearing.page import write_rearing_page
from experiment_manager.report import page as report_page
from experiment_manager.report.condition_figures import conditions_figure
from experiment_manager.report.dictionary_figures import dictionary_figure
from experiment_manager.report.groups import Group, groups_of
from experiment_manager.report.motor_space_figure import motor_space, motor_space_figure
from experiment_manager.report.performance_figures import (
    FIGURES,
    STYLE,
    box_figure,
    performance_figure,
    save,
)
from experiment_manager.report.picture_figures import anaglyph_figure, encoding_figure
from experiment_manager.report.tables import (
    bias_table,
    comparison_table,
    iterations_table,
    resting_table,
    runs_table,
    tests_of_run_table,
)
from experiment_manager.run import checkpoint
from experiment_manager.run.lasting_output import make_standard_streams_last
from eye_plant.mechanics.model import MechanicsConfig
from lockstep.configuration import build
from lockstep.durable_files import replace_file
from lockstep.errors import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT

REPORT_FILE = "report.html"
_PLANT_PREFIX = "mechanics."


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code: 0, or 2 with one line that says what is wrong."""
    options = _parser().parse_args(arguments)
    directory = options.out or (options.runs[0] if len(options.runs) == 1 else Path("report"))
    try:
        write = write_rearing_page if options.rearing else write_report
        path = write(options.runs, directory)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    print(path)
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="report.sh",
        description="Draw the paper's figures from the bags of runs into one report.html. Runs that"
        " differ in their seed alone are pooled, as the paper does.",
    )
    parser.add_argument("runs", type=Path, nargs="+", metavar="RUN", help="run directory")
    parser.add_argument(
        "--rearing",
        action="store_true",
        help="instead, rearing.html: the conditions of altered rearing beside one another, from"
        " results.json and the newest checkpoint of each run (about 20 s a run)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="DIR",
        help="where report.html and figures/ go (default: the run's directory, or report/ for"
        " several runs)",
    )
    return parser


def write_report(directories: Sequence[Path], out: Path) -> Path:
    """Write report.html and figures/ into out; return the page's path.

    Raises InputError for a directory that is no run, or a run without a complete test.
    """
    runs = [RecordedRun(directory) for directory in directories]
    for run in runs:
        if not run.tests:
            raise InputError(f"{run.directory}: expected at least one complete test in its bag")
    groups = groups_of(runs)
    parts = _tables(groups)
    with mpl.rc_context(STYLE):
        for drawing in _drawings(groups):
            figure = drawing.draw()
            if figure is None:
                parts.append(report_page.paragraph(drawing.absence))
                continue
            save(figure, out / FIGURES / f"{drawing.name}.png")
            parts += [
                report_page.heading(drawing.title),
                report_page.picture(figure, drawing.caption),
            ]
    parts += _configurations(runs)
    page = report_page.page("Learning of active binocular vision", parts)
    replace_file(out / REPORT_FILE, page.encode())
    return out / REPORT_FILE


@dataclass(frozen=True)
class _Drawing:
    """A figure of the report, and what stands there when the run has nothing to draw it from."""

    name: str
    title: str
    caption: str
    draw: Callable[[], Figure | None]
    absence: str = ""


def _tables(groups: Sequence[Group]) -> list[str]:
    return [
        report_page.heading("Runs"),
        runs_table(groups),
        report_page.heading("The paper and ours, after 20 iterations of a trial"),
        comparison_table(groups),
        report_page.paragraph(
            "Our test set has the start errors from -3 deg to the largest whole degree that leaves "
            "a vergence of 0 or more; the authors' code stops at +2 deg and leaves out the trials "
            "that start at zero error, so its test set is those of our trials that start at -3, "
            "-2, -1, +1 or +2 deg. The paper gives four interquartile ranges, 0.319 and 1.076 deg, "
            "from a plant and pictures of its own. The right muscle to be silent, below an "
            "activation of 0.005, is the lateral rectus up to 2 m and the medial one from 4 m on; "
            "other distances do not count in that share."
        ),
        report_page.heading("Bias"),
        report_page.paragraph(
            "Median of the signed error by object distance, after 20 iterations, over our test "
            "set. Above 0 the eyes end with too little vergence."
        ),
        bias_table(groups),
        report_page.heading("During a trial, at the end of training"),
        iterations_table(groups),
    ]


def _drawings(groups: Sequence[Group]) -> Iterator[_Drawing]:
    yield _Drawing(
        "performance",
        "Test performance over the course of training (K17 Fig. 2)",
        "Above: median and quartiles of the absolute vergence error (left), and median of the "
        "metabolic rate above the least possible one (right, dashed). Below: the same errors on a "
        "logarithmic axis.",
        lambda: performance_figure(groups),
    )
    yield _Drawing(
        "boxes",
        "Test performance at the end of training (K17 Fig. 3)",
        "After iterations 1, 2, 3 and 20 of the trials. Boxes are quartiles, whiskers reach the "
        "last value within 1.5 interquartile ranges, values beyond are not drawn. c is not defined "
        "for trials that start within 10 mW of the least cost.",
        lambda: box_figure(groups),
    )
    for number, (mechanics, members) in enumerate(_by_plant(groups)):
        yield _Drawing(
            f"motor_space_{number}" if number else "motor_space",
            "Muscles and their cost (K17 Fig. 4)",
            "Metabolic rate (grey, white contours) over the activations of both eyes' horizontal "
            "recti. Black: gaze on the object, dashed: 1 px off. Paths of the last test's trials of"
            " the first stimulus that start at -3, -1, 1 and 3 deg of error; in the corner the "
            "median rate at their ends, by the colour of the frame.",
            partial(_motor_space, mechanics, members),
        )
    yield _Drawing(
        "conditions",
        "Where it succeeds, and where not",
        "Median absolute vergence error after the last test's trials in deg, by where the object "
        "stands and by the error that the trial starts with. White is 1 px, blue less, red more.",
        lambda: conditions_figure(groups),
    )
    yield _Drawing(
        "encoding",
        "What drives the learning",
        "Reconstruction error against vergence error in the first and the last test: median and "
        "quartiles over all iterations, in bins of 0.25 deg.",
        lambda: encoding_figure(groups),
    )
    for number, group in enumerate(groups):
        yield from _drawings_of_run(group.runs[0], f"{number}_{group.model}")


def _drawings_of_run(run: RecordedRun, mark: str) -> Iterator[_Drawing]:
    yield _Drawing(
        f"dictionaries_{mark}",
        f"Basis functions of {run.name}",
        "Left eye's part beside the right eye's, each pair scaled by its largest entry. First "
        "those whose parts match when shifted along the row, by that preferred disparity, positive "
        "when the pattern lies farther right in the left eye; then the others, the most alike in "
        "strength first. Below, how many prefer which disparity.",
        lambda: _dictionaries(run),
        f"{run.name} has no checkpoint to take basis functions from.",
    )
    yield _Drawing(
        f"anaglyphs_{mark}",
        f"What the eyes of {run.name} see",
        "One trial in the first and in the last test, at its start and at its end: left eye in red,"
        " right eye in cyan. Colour fringes are disparity; the frame is the coarse scale's window. "
        "Of the trials with pictures, the one that ends with the median error.",
        lambda: anaglyph_figure(run),
        f"The bag of {run.name} has no pictures of a trial common to its first and last test.",
    )


def _dictionaries(run: RecordedRun) -> Figure | None:
    found = checkpoint.newest(run.directory / "checkpoints")
    if found is None:
        return None
    with np.load(found[1] / "sparse_coder.npz") as state:
        return dictionary_figure(state["atoms"])


def _motor_space(mechanics: MechanicsConfig, groups: Sequence[Group]) -> Figure:
    return motor_space_figure(motor_space(mechanics), groups)


def _by_plant(groups: Sequence[Group]) -> list[tuple[MechanicsConfig, list[Group]]]:
    """Return the groups by the plant of their first runs."""
    found: list[tuple[MechanicsConfig, list[Group]]] = []
    for group in groups:
        mechanics = _mechanics(group.runs[0])
        for known, members in found:
            if known == mechanics:
                members.append(group)
                break
        else:
            found.append((mechanics, [group]))
    return found


def _mechanics(run: RecordedRun) -> MechanicsConfig:
    parameters = run.parameters("eye_plant")
    chosen = {
        name.removeprefix(_PLANT_PREFIX): value
        for name, value in parameters.items()
        if name.startswith(_PLANT_PREFIX)
    }
    return build(MechanicsConfig, chosen)


def _configurations(runs: Sequence[RecordedRun]) -> list[str]:
    parts = [
        report_page.heading("Tests of each run"),
        report_page.paragraph(
            "Below each run's tests, of what the error that is left is made. A trial rests at the "
            "mean error of its second half; those are told that rest within 1 deg. Bias: median "
            "of all resting places. SD within: among trials of one picture and distance, which "
            "start from other errors and activations, median over pairs. SD between: of the "
            "pairs' means. SD over time: in the second half, median over trials. Share left: of a "
            "distance of 0.03 to 0.3 deg to the resting place, after one more iteration."
        ),
    ]
    for run in runs:
        parts += [
            report_page.paragraph(f"{run.name} (model {run.model}, seed {run.seed})"),
            tests_of_run_table(run),
            resting_table(run),
        ]
    parts.append(report_page.heading("Configuration"))
    for run in runs:
        versions = yaml.safe_dump(list(run.versions))
        parts.append(
            report_page.folded(
                f"{run.name}: commit {run.commit or 'unknown'}, seed {run.seed}",
                f"{versions}\n{run.configuration}",
            )
        )
    return parts


if __name__ == "__main__":
    # Who reads the text may have seen enough of it, as head has.
    make_standard_streams_last()
    sys.exit(main())
