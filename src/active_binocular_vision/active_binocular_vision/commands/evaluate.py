"""Measures a run again, from its bag alone."""

import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from msgspec import to_builtins
from msgspec.structs import replace

from active_binocular_vision.command_lines.evaluate import parser
from active_binocular_vision.runs.run import Run
from experiment_manager.measures.results import (
    RESULTS_FILE,
    CostShares,
    Results,
    read_results,
)
from experiment_manager.measures.tables import number, summaries_table
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_DIFFERENT

# Sums may be taken in another order; everything else is the same arithmetic on the same doubles.
_RELATIVE_TOLERANCE = 1e-9


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return 0, 1 when the bag has other numbers, 2 for bad input."""
    options = parser().parse_args(arguments)
    try:
        return _evaluate(options.run)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT


def _evaluate(directory: Path) -> int:
    run = Run(directory)
    measured = run.results_of_bag()
    print(_text(measured))
    path = directory / RESULTS_FILE
    first = run.recorded.first_observation
    if first > 0:
        print(
            f"\nThe bag begins with observation {first}: the run was continued from a "
            "checkpoint without its earlier bag."
        )
    if not path.exists():
        print(f"\nThere is no {path} to compare with.")
        return 0
    expected = read_results(path)
    differences = different_entries(
        _as_far_as(measured, expected) if first > 0 else expected, measured
    )
    for difference in differences:
        print(f"different: {difference}", file=sys.stderr)
    if differences:
        return EXIT_DIFFERENT
    n_entries = len(dict(_entries(to_builtins(measured))))
    print(f"\nAll {n_entries} entries of {path} follow from the bag.")
    return 0


def _text(results: Results) -> str:
    title = (
        f"model {results.model}, seed {results.seed}, {results.iterations} iterations, "
        f"lambda {results.metabolic_cost_weight:g} per W, its share of the reward "
        f"{number(results.cost_shares.first_5000)} at the start and "
        f"{number(results.cost_shares.last_5000)} at the end"
    )
    return f"{title}\n\n{summaries_table(results.tests)}"


def _as_far_as(measured: Results, expected: Results) -> Results:
    """Return results without the tests and shares that are not in a bag which begins late."""
    iterations = {test.iteration for test in measured.tests}
    first, last = measured.cost_shares.first_5000, measured.cost_shares.last_5000
    return replace(
        expected,
        tests=tuple(test for test in expected.tests if test.iteration in iterations),
        cost_shares=CostShares(
            None if first is None else expected.cost_shares.first_5000,
            None if last is None else expected.cost_shares.last_5000,
        ),
    )


def different_entries(expected: Results, measured: Results) -> list[str]:
    """Return "path: expected, got" for each entry in which two results.json differ.

    A measure that the expected one has nowhere is newer than that file.
    """
    left, right = (dict(_entries(to_builtins(results))) for results in (expected, measured))
    names = {path.rpartition(".")[2] for path in left}
    both = [*left, *(path for path in right if path.rpartition(".")[2] in names)]
    return [
        f"{path}: results.json has {left.get(path, 'nothing')}, "
        f"the bag gives {right.get(path, 'nothing')}"
        for path in dict.fromkeys(both)
        if not _equal(left.get(path, "nothing"), right.get(path, "nothing"))
    ]


def _entries(value: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield (path, leaf) of a nested document."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _entries(inner, f"{path}.{key}" if path else key)
    elif isinstance(value, list | tuple):
        for i, inner in enumerate(value):
            yield from _entries(inner, f"{path}[{i}]")
    else:
        yield path, value


def _equal(left: Any, right: Any) -> bool:
    if isinstance(left, float) and isinstance(right, int | float):
        return math.isclose(left, right, rel_tol=_RELATIVE_TOLERANCE, abs_tol=1e-12)
    return bool(left == right)
