"""The report: the paper's numbers beside those of runs, figures, and how the runs were made."""

from collections.abc import Sequence
from pathlib import Path

import yaml

from active_binocular_vision.figures.style import own_style
from active_binocular_vision.pages import html
from active_binocular_vision.pages.report.drawings import drawings
from active_binocular_vision.pages.report.tables import (
    antagonist_rows,
    bias_rows,
    comparison_rows,
    fixation_rows,
    held_rows,
    iteration_rows,
    learning_rows,
    resting_rows,
    run_rows,
    seed_rows,
    yoked_rows,
)
from active_binocular_vision.runs.groups import Group, groups_of
from active_binocular_vision.runs.run import Run
from lockstep.files.durable_files import replace_file

REPORT_FILE = "report.html"
_RUNS = (
    "Lambda's share of the reward is that over the first and over the last 5,000 training "
    "iterations."
)
_POOLED = (
    "Over all trials of all seeds. c is shown where at least half of the trials end within one "
    "pixel."
)
_ABOUT_PAIR = (
    "Our test set has the start errors from -3 deg to the largest whole degree that leaves "
    "a vergence of 0 or more, as the paper's text has it. Its numbers are those of the authors' "
    "code, whose trials start at -2, -4/3, -2/3 deg and thirds of up to 2 deg; nearest to them are "
    "our trials that start at -3, -2, -1, 1 or 2 deg (starts up to 2 deg; abv examine "
    "--start-errors code makes the authors' own). The paper gives four interquartile "
    "ranges, 0.319 and 1.076 deg, from a plant and stimuli of its own. Antagonist silent: the "
    "lateral rectus up to 2 m, the medial one from 4 m on; other distances do not count in that "
    "share, and both may be silent."
)
# Of groups with more commands than the pair.
_ABOUT_OTHERS = (
    "Where each muscle has a command of its own, trials start with errors drawn about all axes "
    "that the commands turn. Within 1 px are both the horizontal and the vertical error."
)
_SEEDS = (
    "Mean over seeds ± half of its 95 % t interval, n being the number of seeds: trials of one "
    "seed are not independent. In brackets the least and the greatest seed. Our test set."
)
_BIAS = (
    "Median of the signed error by object distance, after 20 iterations, over our test set. Above "
    "0 the eyes end with too little vergence."
)
_ANTAGONISTS = (
    "After 20 iterations, over our test set: share of the trials in which both of two antagonists, "
    "one or none are active, at 0.005 or more above the least that commands may set; by object "
    "distance, too. Lesser activation: median of the lesser of both. Slope: of the lesser over the "
    "greater activation, across trials in which one is active: -1 where a muscle relaxes as much "
    "as its antagonist contracts (graded reciprocity, Sherrington's law), 0 where the antagonist "
    "is silent anyway, above 0 where both contract together. In monkeys the ratio of two slopes "
    "over eye position, either way (doi 10.1152/jn.00935.2010). A human horizontal rectus pulls "
    "with about 10 gf straight ahead (Dean, Porrill & Warren 1999, doi 10.1152/jn.1999.81.2.735)."
)
_HELD = (
    "Energy, of eyes without gaze targets: C over the least rate with the gaze and the errors that "
    "the eyes have, median over 14 of each run's trials; beside it over C* with free version."
)
_YOKED = (
    "Hering's law of equal innervation: muscles of the two eyes that turn them to the same side "
    "are yoked. Median difference of their activations before the first and after the last "
    "iteration, and their correlation after the last one, over trials with the same object "
    "distance."
)
_FIXATIONS = (
    "Median / 90 % of absolute values over all fixations of the last test: angle between the left "
    "line of sight and the target after each of two saccades, how far that line moves over five "
    "iterations of vergence, and the errors after these. All: means over seeds ± half of the 95 % "
    "interval."
)
_TESTS = (
    "Below each run's tests: the parts of the remaining error. A trial ends at the mean error of "
    "its second half; those that end within 1 deg count. Bias: median of these errors. SD within: "
    "among trials of one stimulus and distance, which start from other errors and activations, "
    "median over pairs. SD between: of the pairs' means. SD over time: in the second half, median "
    "over trials. Share left after an iteration: of a distance of 0.03 to 0.3 deg from where the "
    "trial ends."
)


def write_report(runs: Sequence[Run], out: Path) -> Path:
    """Write report.html and figures/ into out; return the page's path.

    runs: each with a test. Raises InputError for what is damaged in them.
    """
    groups = groups_of(runs)
    parts = _tables(groups)
    with own_style():
        parts += [part for drawing in drawings(groups) for part in drawing.parts(out)]
    parts += _tests(runs) + _configurations(runs)
    page = html.page("Learning of active binocular vision", parts)
    replace_file(out / REPORT_FILE, page.encode())
    return out / REPORT_FILE


def _tables(groups: Sequence[Group]) -> list[str]:
    are_of_pair = {group.is_of_pair for group in groups}
    paper = "The paper and ours, after" if True in are_of_pair else "After"
    about = {True: _ABOUT_PAIR, False: _ABOUT_OTHERS}
    return [
        *html.section("Runs", _RUNS, run_rows(groups)),
        *html.section(
            f"{paper} 20 iterations of a trial",
            _POOLED,
            comparison_rows(groups),
        ),
        *(html.paragraph(about[kind]) for kind in (True, False) if kind in are_of_pair),
        *html.section("Over seeds", _SEEDS, seed_rows(groups)),
        *html.section(
            "",
            "The same of the trials that start at -3, -2, -1, 1 or 2 deg.",
            seed_rows(groups, up_to_2_deg=True),
        ),
        *html.section("Bias", _BIAS, bias_rows(groups)),
        *html.section("Antagonists", _ANTAGONISTS, antagonist_rows(groups)),
        *html.section("", _HELD, held_rows(groups)),
        *html.section("", _YOKED, yoked_rows(groups)),
        *html.section("Fixations", _FIXATIONS, fixation_rows(groups)),
        *html.section(
            "During a trial, at the end of training",
            "After the first iterations of a trial and at its end.",
            iteration_rows(groups),
        ),
    ]


def _tests(runs: Sequence[Run]) -> list[str]:
    parts = [html.heading("Tests of each run"), html.paragraph(_TESTS)]
    for run in runs:
        about = f"{run.name} (model {run.model}, seed {run.seed})"
        parts += html.section("", about, learning_rows(run))
        if run.bag is None:
            parts.append(html.paragraph("The parts of the remaining error need a bag."))
        else:
            parts.append(html.table(resting_rows(run.recorded.tests)))
    return parts


def _configurations(runs: Sequence[Run]) -> list[str]:
    texts = {run: f"{yaml.safe_dump(list(run.versions))}\n{run.configuration_text}" for run in runs}
    return [html.heading("Configuration")] + [
        html.folded(f"{run.name}: commit {run.commit or 'unknown'}, seed {run.seed}", text)
        for run, text in texts.items()
    ]
