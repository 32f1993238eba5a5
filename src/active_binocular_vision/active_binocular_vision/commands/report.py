"""One self-contained report.html from one or more runs, or a sweep, beside the paper's numbers."""

import sys
from collections.abc import Sequence
from pathlib import Path

from active_binocular_vision.command_lines.report import parser
from active_binocular_vision.pages.conditions.page import write_conditions_page
from active_binocular_vision.pages.report.page import write_report
from active_binocular_vision.runs.conditions import chosen_columns
from active_binocular_vision.runs.groups import held_back
from active_binocular_vision.runs.results_folder import keep, runs_with_tests
from active_binocular_vision.runs.run import Run
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT


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


def _runs(paths: Sequence[Path]) -> list[Run]:
    """Return the runs at paths, and in the sweeps there; others are left out, with a message."""
    runs, reasons = runs_with_tests(paths)
    for run in held_back(runs):
        runs.remove(run)
        reasons.append(
            f"{run.directory}: its last test is after {run.summaries[-1].iteration:,} "
            f"iterations of {run.n_iterations:,}, where others that it is pooled with have ended"
        )
    for reason in reasons:
        print(f"left out: {reason}", file=sys.stderr)
    return runs
