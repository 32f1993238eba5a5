"""Measures a run: from its bag alone, or what its frozen learners do with other pictures."""

import argparse
import json
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from msgspec import to_builtins
from msgspec.structs import replace

from active_binocular_vision.commands.command_line import plant_settings
from active_binocular_vision.commands.examinations import (
    add_examinations,
    examined,
)
from active_binocular_vision.examinations.registry import EXAMINATIONS
from active_binocular_vision.learners.evaluation import evaluated
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from active_binocular_vision.runs.finished_run import FinishedRun
from experiment_manager.measures.results import (
    RESULTS_FILE,
    CostShares,
    Results,
    read_results,
    write_document,
)
from experiment_manager.measures.tables import number, summaries_table
from lockstep import InputError
from lockstep.command_line import CommandLine
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_DIFFERENT
from lockstep.machine.lasting_output import ignore_broken_pipes

# Sums may be taken in another order; everything else is the same arithmetic on the same doubles.
_RELATIVE_TOLERANCE = 1e-9
# What asks for a test of frozen learners.
_FROZEN = (
    "checkpoint",
    "stimuli",
    "stereograms",
    "random_dots",
    "generated",
    "dictionary",
    "actor",
    "set",
    "start_scale",
    "examination",
)
_FROZEN_OPTIONS = ", ".join(
    f"--{name.replace('_', '-')}" for name in (*_FROZEN[:-1], *EXAMINATIONS)
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return 0, 1 when the bag has other numbers, 2 for bad input."""
    line = parser()
    options = line.parse_args(arguments)
    is_frozen = any(getattr(options, name) != line.get_default(name) for name in _FROZEN)
    if not is_frozen and (
        options.stimuli_per_test is not None or options.out is not None or options.json
    ):
        line.error(f"--stimuli-per-test, --out and --json: expected with one of {_FROZEN_OPTIONS}")
    for name in ("figure", "option"):
        if getattr(options, name) and options.examination is None:
            line.error(
                f"--{name}: expected with one of {', '.join(f'--{n}' for n in EXAMINATIONS)}"
            )
    if options.examination is not None and options.start_scale is not None:
        line.error("--start-scale: expected without an examination, which has starts of its own")
    try:
        if is_frozen:
            return _test_frozen(options)
        return _evaluate(options.run)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT


def parser() -> argparse.ArgumentParser:
    """Return the command line of evaluate.sh."""
    line = CommandLine(
        prog="evaluate.sh",
        description="Recompute the measures of a run from its bag; compare them with results.json."
        f" With any of {_FROZEN_OPTIONS}: test the learners of a checkpoint instead, without"
        " learning; this needs only config.yaml and checkpoints/ of the run.",
    )
    line.add_argument("run", type=Path, metavar="RUN", help="run directory")
    _add_shown(line)
    _add_learners(line)
    add_examinations(line)
    line.add_argument(
        "--out", type=Path, metavar="FILE", help="also write the measures of the test as JSON"
    )
    line.add_argument("--json", action="store_true", help="print that JSON in place of the table")
    return line


def _add_shown(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("what the learners are tested on")
    group.add_argument(
        "--stimuli",
        type=Path,
        metavar="DIR",
        help="images in DIR/test, or all in DIR (default: the test stimuli of the run)",
    )
    group.add_argument(
        "--stereograms",
        type=Path,
        metavar="DIR",
        help="pairs of images, one for each eye: NAME_left and NAME_right",
    )
    group.add_argument("--random-dots", action="store_true", help="random-dot stereograms")
    group.add_argument(
        "--generated",
        action="store_true",
        help="the generated test stimuli, for a run that was trained on other images",
    )
    group.add_argument(
        "--stimuli-per-test",
        type=int,
        metavar="K",
        help="largest number of images, with 39 trials each (42 with a command for each muscle;"
        " default: as in the tests of the run)",
    )
    group.add_argument(
        "--start-scale",
        type=float,
        metavar="FACTOR",
        help="multiply the start errors and versions of the tests by FACTOR; only with a command"
        " for each muscle",
    )


def _add_learners(line: argparse.ArgumentParser) -> None:
    group = line.add_argument_group("which learners, with which eyes")
    group.add_argument(
        "--dictionary",
        type=Path,
        metavar="CHECKPOINT",
        help="take the dictionaries from this directory in checkpoints/ of any run",
    )
    group.add_argument(
        "--actor",
        type=Path,
        metavar="CHECKPOINT",
        help="take the learner of the commands from this directory in checkpoints/",
    )
    group.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="eyes.NAME=VALUE",
        help="change a setting of the eyes for the test; may be repeated",
    )
    group.add_argument(
        "--checkpoint",
        type=int,
        metavar="PLACE",
        help="number of the directory in checkpoints/ whose learners are tested (default: the"
        " newest)",
    )


def _test_frozen(options: argparse.Namespace) -> int:
    learners = FrozenLearners(
        options.run,
        options.checkpoint,
        dictionary=options.dictionary,
        actor=options.actor,
        settings=plant_settings(options.set),
    )
    shown = Shown(
        options.stimuli,
        options.stereograms,
        options.random_dots,
        options.generated,
        options.stimuli_per_test,
    )
    if options.examination is not None:
        document, table = examined(
            options.examination, learners, shown, options.figure, options.option
        )
    else:
        start_scale = 1.0 if options.start_scale is None else options.start_scale
        results = evaluated(learners, shown, start_scale)
        document, table = results.to_json(), summaries_table([results.test])
    if options.json:
        print(json.dumps(document, indent=2))
    else:
        manager = learners.manager
        print(
            f"model {manager.model}, seed {manager.seed}, checkpoint after "
            f"{learners.place} episodes, {document['n_stimuli']} pictures of "
            f"{document['stimuli'] or 'its own test stimuli'}\n\n{table}"
        )
    if options.out is not None:
        write_document(options.out, document)
        print(f"written: {options.out}", file=sys.stderr)
    return 0


def _evaluate(directory: Path) -> int:
    run = FinishedRun(directory)
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
    """Return "path: expected, got" for each entry in which two results.json differ."""
    left, right = (dict(_entries(to_builtins(results))) for results in (expected, measured))
    return [
        f"{path}: results.json has {left.get(path, 'nothing')}, "
        f"the bag gives {right.get(path, 'nothing')}"
        for path in dict.fromkeys([*left, *right])
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


if __name__ == "__main__":
    ignore_broken_pipes()
    sys.exit(main())
