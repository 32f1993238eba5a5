"""Lists trained eyes, or makes a file of them from a run."""

import sys
from collections.abc import Sequence

from active_binocular_vision.command_lines.trained import parser
from active_binocular_vision.runs.run import Run
from experiment_manager.measures.tables import number, percent, text_table
from experiment_manager.trained.directory import file_of, pack, trained_eyes
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code: 0, or 2 with one line that says what is wrong."""
    options = parser().parse_args(arguments)
    try:
        if options.run is None:
            if options.out is not None:
                raise InputError("--out: expected it with RUN, got it alone")
            print(_table() if trained_eyes() else "no trained eyes come with this package")
        else:
            file = options.out or file_of(Run(options.run).profile)
            print(f"{file}: {pack(options.run, file) / 1e6:.2f} MB")
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    return 0


def _table() -> str:
    header = ("name", "model", "iterations", "|vergence error|/deg", "within 1 px", "MB")
    rows = []
    for name, file in trained_eyes().items():
        run = Run(name)
        last = run.summaries[-1]
        rows.append(
            (
                name,
                run.model,
                f"{run.n_iterations:,}",
                number(last.median_abs_vergence_error_deg),
                percent(last.share_within_1_px),
                f"{file.stat().st_size / 1e6:.2f}",
            )
        )
    return text_table(header, rows, n_left=2)
