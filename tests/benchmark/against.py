"""Another commit's own benchmark, from a worktree of it, in turns with this one's."""

import contextlib
import json
import os
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

ROOT = Path(__file__).parents[2]
_SCRIPT = Path("launch_scripts/benchmark.sh")


@contextlib.contextmanager
def worktree(revision: str, directory: Path) -> Iterator[Path]:
    """Check out the commit to directory/worktree for a while; RuntimeError when there is none."""
    root = directory / "worktree"
    _git("worktree", "add", "--detach", "--quiet", str(root), revision)
    try:
        yield root
    finally:
        _git("worktree", "remove", "--force", str(root))


def quick_results(root: Path, json_file: Path) -> dict[str, Any]:
    """Return what the quick benchmark of the code in root measures, in a process of its own.

    The Python environment is this one's. Raises RuntimeError when it fails.
    """
    # Before the packages that the environment names, which are this checkout's.
    path = os.pathsep.join(str(folder) for folder in (root, *sorted((root / "src").iterdir())))
    ended = subprocess.run(
        [sys.executable, "-m", benchmark_module(root), "--quick", "--json", str(json_file)],
        cwd=root,
        env=os.environ | {"PYTHONPATH": path},
        stdout=subprocess.DEVNULL,
        check=False,
    )
    if ended.returncode != 0:
        raise RuntimeError(f"the benchmark in {root} ended with exit code {ended.returncode}")
    return dict(json.loads(json_file.read_text()))


def benchmark_module(root: Path) -> str:
    """Return the module that the benchmark.sh of the code in root starts."""
    found = re.search(r"^run_module (\S+)", (root / _SCRIPT).read_text(), re.MULTILINE)
    if found is None:
        raise RuntimeError(f"{root / _SCRIPT}: expected a line run_module MODULE, got none")
    return found[1]


def results_in_turns(revision: str, n_turns: int, directory: Path) -> dict[str, Any]:
    """Return "against", the other commit's results, and "against_ratios", ours over theirs.

    Both are medians over the turns, of every number that both measure; of numbers inside others
    the name is outer.inner.
    """
    ours: list[dict[str, float]] = []
    theirs: list[dict[str, float]] = []
    with worktree(revision, directory) as other:
        for i_turn in range(n_turns):
            for root, results in ((ROOT, ours), (other, theirs)):
                print(f"measuring against {revision}: turn {i_turn}, {root}", file=sys.stderr)
                results.append(numbers_of(quick_results(root, directory / "turn.json")))
    return {
        "against": {"revision": revision} | medians(theirs),
        "against_ratios": ratios(ours, theirs),
    }


def numbers_of(results: Mapping[str, Any]) -> dict[str, float]:
    """Return the numbers of a benchmark's JSON document by name, without what is not measured."""
    numbers: dict[str, float] = {}
    for name, value in results.items():
        if isinstance(value, dict):
            numbers |= {f"{name}.{inner}": number for inner, number in numbers_of(value).items()}
        elif isinstance(value, int | float):
            numbers[name] = float(value)
    return numbers


def medians(turns: Sequence[Mapping[str, float]]) -> dict[str, float]:
    """Return the median over turns of each number that all have."""
    names = [name for name in turns[0] if all(name in turn for turn in turns)]
    return {name: float(np.median([turn[name] for turn in turns])) for name in names}


def ratios(
    ours: Sequence[Mapping[str, float]], theirs: Sequence[Mapping[str, float]]
) -> dict[str, float]:
    """Return the median over turns of ours / theirs, of each number that both have and is not 0."""
    turns = [
        {name: mine[name] / other[name] for name in mine if other.get(name)}
        for mine, other in zip(ours, theirs, strict=True)
    ]
    return medians(turns)


def _git(*arguments: str) -> None:
    ended = subprocess.run(
        ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=False
    )
    if ended.returncode != 0:
        raise RuntimeError(f"git {' '.join(arguments)}: {ended.stderr.strip()}")
