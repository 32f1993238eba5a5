"""Recomputes every number of results.json from the bag alone, and says whether they agree."""

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from experiment_manager.recorded_run import RecordedRun
from experiment_manager.results import RESULTS_FILE, read_results, write_document
from experiment_manager.tables import number, tests_table
from lockstep.errors import InputError

EXIT_DIFFERENT = 1
EXIT_BAD_INPUT = 2
# Sums may be taken in another order; everything else is the same arithmetic on the same doubles.
_RELATIVE_TOLERANCE = 1e-9


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return 0, 1 when the bag tells other numbers, 2 for bad input."""
    options = _parser().parse_args(arguments)
    try:
        return _evaluate(options.run, write=options.write)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="evaluate.sh",
        description="Recompute the measures of a run from its bag and compare with results.json.",
    )
    parser.add_argument("run", type=Path, metavar="RUN", help="run directory")
    parser.add_argument(
        "--write", action="store_true", help="write results.json from the bag instead"
    )
    return parser


def _evaluate(directory: Path, *, write: bool) -> int:
    run = RecordedRun(directory)
    found = run.results()
    print(_text(found))
    path = directory / RESULTS_FILE
    if write:
        write_document(path, found)
        print(f"\nwritten: {path}")
        return 0
    if not path.exists():
        print(f"\nThere is no {path} to compare with (--write makes one).")
        return 0
    differences = different_entries(read_results(path), found)
    for difference in differences:
        print(f"different: {difference}", file=sys.stderr)
    if differences:
        return EXIT_DIFFERENT
    print(f"\nAll {sum(1 for _ in _entries(found))} entries of {path} follow from the bag.")
    return 0


def _text(results: dict[str, Any]) -> str:
    share = results["lambda_share"]
    title = (
        f"model {results['model']}, seed {results['seed']}, {results['iterations']} iterations, "
        f"lambda {results['lambda']:g} per W, its share of the reward "
        f"{number(share['first_5000'])} at the start and {number(share['last_5000'])} at the end"
    )
    return f"{title}\n\n{tests_table(results['tests'])}"


def different_entries(expected: dict[str, Any], found: dict[str, Any]) -> list[str]:
    """Return "place: expected, got" for each entry in which two results.json differ."""
    left, right = dict(_entries(expected)), dict(_entries(found))
    return [
        f"{place}: results.json has {left.get(place, 'nothing')}, "
        f"the bag gives {right.get(place, 'nothing')}"
        for place in dict.fromkeys([*left, *right])
        if not _equal(left.get(place, "nothing"), right.get(place, "nothing"))
    ]


def _entries(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    """Yield (place, leaf) of a nested document."""
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _entries(inner, f"{place}.{key}" if place else key)
    elif isinstance(value, list):
        for i, inner in enumerate(value):
            yield from _entries(inner, f"{place}[{i}]")
    else:
        yield place, value


def _equal(left: Any, right: Any) -> bool:
    if isinstance(left, float) and isinstance(right, int | float):
        return math.isclose(left, right, rel_tol=_RELATIVE_TOLERANCE, abs_tol=1e-12)
    return bool(left == right)


if __name__ == "__main__":
    sys.exit(main())
