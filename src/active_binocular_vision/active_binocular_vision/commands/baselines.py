"""Other methods in the test of a run, and their rows beside the run's own."""

import sys
from collections.abc import Mapping, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from active_binocular_vision.baselines.bench import Bench
from active_binocular_vision.baselines.methods import METHODS, Effort, Tested
from active_binocular_vision.baselines.rows import rows_of_method, rows_of_run, table, written
from active_binocular_vision.command_lines.baselines import parser
from active_binocular_vision.commands.run import source_commit
from active_binocular_vision.runs.results_folder import runs_with_tests
from active_binocular_vision.runs.run import Run
from lockstep import InputError, read_state
from lockstep.exit_codes import EXIT_BAD_INPUT


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return 0, or 2 for bad input."""
    options = parser().parse_args(arguments)
    try:
        runs, reasons = runs_with_tests(options.runs)
        for reason in reasons:
            print(f"left out: {reason}", file=sys.stderr)
        rows = written(options.out, [row for run in runs for row in rows_of_run(run)])
        if options.methods:
            effort = Effort(options.every, options.steps)
            state = read_state(_coder_file(runs[0], options.dictionary), "sparse_coder")
            rows = _tested(runs[0], state, options.methods, effort, options.out)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    print(table(rows))
    return 0


def _coder_file(run: Run, dictionary: Path | None) -> Path:
    if dictionary is not None:
        return dictionary
    if run.states is None:
        raise InputError(f"{run.directory}: expected a checkpoint, or --dictionary, got none")
    return run.states / "sparse_coder.npz"


def _tested(
    run: Run, state: Mapping[str, Any], methods: Sequence[str], effort: Effort, out: Path
) -> list[Mapping[str, Any]]:
    """Return all rows of the table, to which each test of each method is added once it is made."""
    rows: list[Mapping[str, Any]] = []
    commit = source_commit()
    with closing(Bench(run, state)) as bench:
        for method in methods:
            print(f"testing {method}", file=sys.stderr, flush=True)
            tests: list[Tested] = []

            def done(tested: Tested, method: str = method, tests: list[Tested] = tests) -> None:
                tests.append(tested)
                rows[:] = written(out, rows_of_method(method, run, bench, tests, commit))

            METHODS[method](bench, effort, done)
    return rows
