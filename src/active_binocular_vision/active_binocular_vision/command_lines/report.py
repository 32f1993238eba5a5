"""The command line of `abv report`."""

import argparse

from active_binocular_vision.command_lines.start import start
from active_binocular_vision.runs.ages import AGES
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path

_COLUMNS = (
    "test.share_within_1_px,test.metabolic_rate_w,cover,acuity,stereo.threshold_arcsec,"
    "tuning.binocular_share_coarse,tuning.binocular_share_fine"
)


def parser() -> argparse.ArgumentParser:
    """Return the command line of `abv report`."""
    line = CommandLine(
        prog=command("report"),
        description="Draw the paper's figures and tables of runs into one report.html, from "
        "results.json, trials.npz, checkpoints and, where they exist, bags. Runs that differ only "
        "in their seed, or in it and the seed of their stimuli, are pooled, as in K17.",
    )
    line.add_argument(
        "runs",
        type=written_path,
        nargs="+",
        metavar="RUN",
        help="directory of a run, of a sweep or of results, or a run of such a folder",
    )
    line.add_argument(
        "--conditions",
        action="store_true",
        help="write conditions.html instead: measures of tests and examinations of each condition,"
        " from each run's examinations.json, or from its checkpoints (about 15 s per age with the"
        " default columns, one run per core)",
    )
    line.add_argument(
        "--keep",
        type=written_path,
        metavar="DIR",
        help="write a folder of results instead, which this command reads in place of the runs:"
        " measures.csv, runs.yaml, trials.npz, examinations.json (results/README.md)",
    )
    line.add_argument(
        "--columns",
        default=_COLUMNS,
        metavar="NAME,...",
        help="columns of conditions.html: EXAMINATION for all its measures, or"
        f" EXAMINATION.MEASURE; test is the run's own test (default: {_COLUMNS})",
    )
    line.add_argument(
        "--ages",
        nargs="+",
        choices=AGES,
        default=AGES,
        help="ages on conditions.html: birth, before the first change, end (default: all)",
    )
    line.add_argument(
        "--out",
        type=written_path,
        metavar="DIR",
        help="where to write report.html and figures/ (default: RUN, or report/ for several)",
    )
    return line


def main() -> None:
    """Run the command line as this process."""
    start("report", parser)


if __name__ == "__main__":
    main()
