"""One self-contained report.html from one or more runs, or a sweep, beside the paper's numbers."""

import sys
from collections.abc import Sequence
from pathlib import Path

import matplotlib as mpl
import yaml

from active_binocular_vision.command_lines.report import parser
from active_binocular_vision.figures.style import FIGURES, STYLE, save
from active_binocular_vision.pages.conditions.page import write_conditions_page
from active_binocular_vision.pages.report import page as report_page
from active_binocular_vision.pages.report.drawings import drawings
from active_binocular_vision.pages.report.tables import (
    antagonists_table,
    bias_table,
    comparison_table,
    fixations_table,
    iterations_table,
    learning_table,
    resting_table,
    runs_table,
    seeds_table,
    yoked_table,
)
from active_binocular_vision.runs.conditions import chosen_columns
from active_binocular_vision.runs.finished_run import FinishedRun
from active_binocular_vision.runs.groups import Group, groups_of, held_back
from active_binocular_vision.runs.results_folder import keep, runs_at
from lockstep import InputError
from lockstep.durable_files import replace_file
from lockstep.exit_codes import EXIT_BAD_INPUT

REPORT_FILE = "report.html"
_ABOUT_PAIR = (
    "Our test set has the start errors from -3 deg to the largest whole degree that leaves "
    "a vergence of 0 or more; the authors' code stops at +2 deg and leaves out the trials "
    "that start at zero error, so its test set contains only our trials that start at -3, "
    "-2, -1, +1 or +2 deg. The paper gives four interquartile ranges, 0.319 and 1.076 deg, "
    "from a plant and pictures of its own. The antagonist, silent below an "
    "activation of 0.005, is the lateral rectus up to 2 m and the medial one from 4 m on; "
    "other distances do not count in that share."
)
# Of groups with more commands than the pair.
_ABOUT_OTHERS = (
    "Where each muscle has a command of its own, trials start with errors drawn about all axes "
    "that the commands turn. Within 1 px are both the horizontal and the vertical error. The "
    "antagonist is silent where one of the two horizontal recti of an eye is."
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code: 0, or 2 with one line that says what is wrong."""
    options = parser().parse_args(arguments)
    directory = options.out or (options.runs[0] if len(options.runs) == 1 else Path("report"))
    try:
        if options.keep is not None:
            keep(_runs(options.runs), options.keep)
            path = options.keep
        elif options.conditions:
            columns = chosen_columns(options.columns)
            path = write_conditions_page(options.runs, directory, columns, options.ages)
        else:
            path = write_report(_runs(options.runs), directory)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    print(path)
    return 0


def _runs(paths: Sequence[Path]) -> list[FinishedRun]:
    """Return the runs at paths, and in the sweeps there; others are left out, with a message.

    Raises InputError when none is left, with what is wrong with the first.
    """
    runs: list[FinishedRun] = []
    reasons: list[str] = []
    found = {run.directory.resolve(): run for path in paths for run in runs_at(path)}
    for run in found.values():
        try:
            if not run.summaries:
                raise InputError(f"{run.directory}: expected at least one complete test")
        except InputError as error:
            reasons.append(str(error))
        else:
            runs.append(run)
    for run in held_back(runs):
        runs.remove(run)
        reasons.append(
            f"{run.directory}: its last test is after {run.summaries[-1].iteration:,} "
            f"iterations of {run.n_iterations:,}, where others that it is pooled with have ended"
        )
    if not runs:
        raise InputError(reasons[0] if reasons else f"{paths[0]}: expected runs in the sweep")
    for reason in reasons:
        print(f"left out: {reason}", file=sys.stderr)
    return runs


def write_report(runs: Sequence[FinishedRun], out: Path) -> Path:
    """Write report.html and figures/ into out; return the page's path.

    runs: each with a test. Raises InputError for what is damaged in them.
    """
    groups = groups_of(runs)
    parts = _tables(groups)
    with mpl.rc_context(STYLE):
        for drawing in drawings(groups):
            figure = drawing.draw()
            parts.append(report_page.heading(drawing.title))
            if figure is None:
                parts.append(report_page.paragraph(drawing.absence))
                continue
            save(figure, out / FIGURES / f"{drawing.name}.png")
            parts.append(
                report_page.picture(figure, f"{drawing.caption} {drawing.left_out}".strip())
            )
    parts += _configurations(runs)
    page = report_page.page("Learning of active binocular vision", parts)
    replace_file(out / REPORT_FILE, page.encode())
    return out / REPORT_FILE


def _tables(groups: Sequence[Group]) -> list[str]:
    are_of_pair = [group.is_of_pair for group in groups]
    compared = "The paper and ours, after 20 iterations of a trial"
    return [
        report_page.heading("Runs"),
        runs_table(groups),
        report_page.paragraph(
            "Lambda's share of the reward is that over the first and over the last 5,000 training "
            "iterations."
        ),
        report_page.heading(compared if any(are_of_pair) else "After 20 iterations of a trial"),
        report_page.paragraph("Over all trials of all seeds."),
        comparison_table(groups),
        *([report_page.paragraph(_ABOUT_PAIR)] if any(are_of_pair) else ()),
        *(() if all(are_of_pair) else [report_page.paragraph(_ABOUT_OTHERS)]),
        *_over_seeds(groups),
        report_page.heading("Bias"),
        report_page.paragraph(
            "Median of the signed error by object distance, after 20 iterations, over our test "
            "set. Above 0 the eyes end with too little vergence."
        ),
        bias_table(groups),
        *(() if all(are_of_pair) else _antagonists(groups)),
        *_fixations(groups),
        report_page.heading("During a trial, at the end of training"),
        iterations_table(groups),
    ]


def _over_seeds(groups: Sequence[Group]) -> list[str]:
    several = [group for group in groups if len(group.runs) > 1]
    if not several:
        return []
    parts = [
        report_page.heading("Over seeds"),
        report_page.paragraph(
            "Median over seeds, in brackets the least and the greatest seed: our test set."
        ),
        seeds_table(groups),
    ]
    if any(group.is_of_pair for group in several):
        parts += [
            report_page.paragraph("The same of the authors' test set."),
            seeds_table(groups, authors=True),
        ]
    return parts


def _antagonists(groups: Sequence[Group]) -> list[str]:
    return [
        report_page.heading("Antagonists"),
        report_page.paragraph(
            "After 20 iterations, over our test set. Co-contraction: median of the lesser "
            "activation of two antagonists, above the least that commands may set. One is silent: "
            "share of trials in which that is below 0.005; by object distance, too."
        ),
        antagonists_table(groups),
        report_page.paragraph(
            "Hering's law of equal innervation: muscles of the two eyes that turn them to the same "
            "side are yoked. Median difference of their activations before the first and after the "
            "last iteration, and their correlation after the last one, over trials with the same "
            "object distance."
        ),
        yoked_table(groups),
    ]


def _fixations(groups: Sequence[Group]) -> list[str]:
    if not any(run.summaries[-1].fixation_spreads for group in groups for run in group.runs):
        return []
    return [
        report_page.heading("Fixations"),
        report_page.paragraph(
            "Median / 90 % of absolute values over all fixations of the last test: angle between "
            "the left line of sight and the target after each of two saccades, how far that line "
            "moves over five iterations of vergence, and the errors after these."
        ),
        fixations_table(groups),
    ]


def _configurations(runs: Sequence[FinishedRun]) -> list[str]:
    parts = [
        report_page.heading("Tests of each run"),
        report_page.paragraph(
            "Below each run's tests: the parts of the remaining error. A trial ends at the mean "
            "error of its second half; those that end within 1 deg count. Bias: median of these "
            "errors. SD within: among trials of one picture and distance, which "
            "start from other errors and activations, median over pairs. SD between: of the "
            "pairs' means. SD over time: in the second half, median over trials. Share left after "
            "an iteration: of a distance of 0.03 to 0.3 deg from where the trial ends."
        ),
    ]
    for run in runs:
        parts += [
            report_page.paragraph(f"{run.name} (model {run.model}, seed {run.seed})"),
            learning_table(run),
            resting_table(run.recorded.tests)
            if run.bag is not None
            else report_page.paragraph("The parts of the remaining error need a bag."),
        ]
    parts.append(report_page.heading("Configuration"))
    for run in runs:
        versions = yaml.safe_dump(list(run.versions))
        parts.append(
            report_page.folded(
                f"{run.name}: commit {run.commit or 'unknown'}, seed {run.seed}",
                f"{versions}\n{run.configuration_text}",
            )
        )
    return parts
