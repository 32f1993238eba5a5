"""torture.sh: the long tests of reliability, and their figures."""

import argparse
import json
import shutil
import sys
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from lockstep.errors import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT
from tests.stress.clock_jumps import jump
from tests.stress.cuts import cut
from tests.stress.disturbed_runs import Found
from tests.stress.hard_starts import kill_starts, limit_memory
from tests.stress.hostile_input import fuzz
from tests.stress.kills import kill_at_work
from tests.stress.soak import soak
from tests.stress.totals import Totals


@dataclass(frozen=True)
class Part:
    """What the command line may ask for.

    option, text: its name and meaning there; default: how much is done; in_a_slice: how much at
    once; counts: the figure that says how much was done; work: does it, in an empty directory.
    """

    option: str
    text: str
    default: int
    in_a_slice: int
    counts: str
    work: Callable[[Path, int, np.random.SeedSequence], Found]


# By their names in the totals. A part's place is in the seeds of its slices.
PARTS = {
    "kills": Part("kills", "nodes to kill", 40, 25, "disturbances", kill_at_work),
    "hostile input": Part("inputs", "hostile inputs", 30_000, 10_000, "inputs", fuzz),
    "cuts": Part("cuts", "cuts; needs root", 0, 6, "cuts", cut),
    "clock jumps": Part("jumps", "clock jumps", 0, 25, "jumps", jump),
    "soak": Part("soak", "iterations of a long run", 200_000, 200_000, "iterations", soak),
    "start kills": Part(
        "start-kills", "kills of starting nodes", 10, 10, "disturbances", kill_starts
    ),
    "memory limits": Part("memory-limits", "memory limits", 10, 10, "disturbances", limit_memory),
}


def _parser() -> argparse.ArgumentParser:
    line = argparse.ArgumentParser(
        prog="torture.sh", description="Run the long tests of reliability."
    )
    for name, part in PARTS.items():
        line.add_argument(
            f"--{part.option}",
            dest=name,
            type=int,
            default=part.default,
            metavar="N",
            help=f"{part.text} (default {part.default})",
        )
    line.add_argument("--seed", type=int, default=1, metavar="S", help="of all random draws")
    line.add_argument(
        "--totals",
        type=Path,
        metavar="FILE",
        help="add up the totals of all slices in FILE, and continue from them",
    )
    line.add_argument("--out", type=Path, metavar="DIR", help="keep the runs in DIR")
    return line


def _slice(name: str, n: int, totals: Totals, options: argparse.Namespace) -> None:
    """Make the next slice of a part, with a seed of its own, and add it to the totals."""
    n_slices = totals.of(name).n_slices
    seeds = np.random.SeedSequence((options.seed, [*PARTS].index(name), n_slices))
    with tempfile.TemporaryDirectory(prefix="torture_") as temporary:
        directory = (
            Path(options.out or temporary).resolve() / f"{name.replace(' ', '_')}_{n_slices}"
        )
        shutil.rmtree(directory, ignore_errors=True)  # of a slice that was broken off
        directory.mkdir(parents=True)
        try:
            figures, problems = PARTS[name].work(directory, n, seeds)
        # A part that cannot go on keeps nobody from the others. A TimeoutError is an OSError.
        except (AssertionError, InputError, OSError, RuntimeError) as error:
            figures, problems = {}, [f"{type(error).__name__}: {error}"]
    totals.add(name, figures.get(PARTS[name].counts, 0), figures, problems)
    print(f"{name}: {totals.of(name).n_done} done, {problems or 'all held'}", flush=True)


def _left(options: argparse.Namespace, totals: Totals) -> dict[str, int]:
    """Return how much is left to do of each part; nothing of one that has failed."""
    wanted = {name: n for name in PARTS if (n := getattr(options, name))}
    left = {name: n - totals.of(name).n_done for name, n in wanted.items()}
    return {name: n for name, n in left.items() if n > 0 and not totals.of(name).problems}


def main(argv: Sequence[str] | None = None) -> int:
    """Run the parts asked for, slice by slice; return 0 when all held."""
    options = _parser().parse_args(argv)
    try:
        totals = Totals(options.totals, options.seed)
    except InputError as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    # By turns, so that each part has been tried early.
    while left := _left(options, totals):
        for name, n in left.items():
            _slice(name, min(n, PARTS[name].in_a_slice), totals, options)
    for name, part in totals.parts.items():
        print(f"{name}: {json.dumps(part.figures)}")
        for problem in part.problems:
            print(f"{name}: FAILED: {problem}", file=sys.stderr)
    return int(any(part.problems for part in totals.parts.values()))


if __name__ == "__main__":
    sys.exit(main())
