"""This commit's and another one's windows in turns, in one sitting."""

import contextlib
import os
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]
_WORKER = Path(__file__).with_name("worker.py")

# Returns the rate of a window of so many seconds.
Window = Callable[[float], float]


@contextlib.contextmanager
def worktree(revision: str, directory: Path) -> Iterator[Path]:
    """Check out the commit to directory/worktree for a while; RuntimeError when there is none."""
    root = directory / "worktree"
    _git("worktree", "add", "--detach", "--quiet", str(root), revision)
    try:
        yield root
    finally:
        _git("worktree", "remove", "--force", str(root))


def _git(*arguments: str) -> None:
    ended = subprocess.run(
        ["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=False
    )
    if ended.returncode != 0:
        raise RuntimeError(f"git {' '.join(arguments)}: {ended.stderr.strip()}")


@contextlib.contextmanager
def worker(root: Path, kind: str) -> Iterator[Window]:
    """Start the code in root, "graph" or "in_process", with this Python environment.

    It is set up when the block is entered. Raises RuntimeError, as the window does, when it ends.
    """
    # Before the packages that the environment names, which are this checkout's.
    path = os.pathsep.join(str(folder) for folder in (root, *sorted((root / "src").iterdir())))
    process = subprocess.Popen(
        [sys.executable, str(_WORKER), kind],
        cwd=root,
        env=os.environ | {"PYTHONPATH": path},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )

    assert process.stdin is not None
    assert process.stdout is not None
    to_worker, from_worker = process.stdin, process.stdout

    def answer() -> str:
        if not (line := from_worker.readline()):
            raise RuntimeError(f"the benchmark in {root} ended with exit code {process.wait()}")
        return line

    def window(duration_s: float) -> float:
        print(duration_s, file=to_worker, flush=True)
        return float(answer())

    try:
        answer()
        yield window
    finally:
        process.communicate()


def rates_in_turns(
    ours: Window, theirs: Window, n_turns: int, window_s: float
) -> tuple[list[float], list[float]]:
    """Return the rates of n_turns windows of each; who begins changes from turn to turn."""
    our_rates, their_rates = list[float](), list[float]()
    for i_turn in range(n_turns):
        pair = [(ours, our_rates), (theirs, their_rates)]
        for window, rates in pair if i_turn % 2 == 0 else reversed(pair):
            rates.append(window(window_s))
    return our_rates, their_rates


def compared(ours: Sequence[float], theirs: Sequence[float]) -> dict[str, float]:
    """Return median rates, and median and quartiles of the turns' ratios, ours over theirs."""
    low, middle, high = np.quantile(np.divide(ours, theirs), (0.25, 0.5, 0.75))
    return {
        "ours_iterations_per_s": float(np.median(ours)),
        "theirs_iterations_per_s": float(np.median(theirs)),
        "ratio": float(middle),
        "ratio_lower_quartile": float(low),
        "ratio_upper_quartile": float(high),
    }


def against(
    revision: str, n_turns: dict[str, int], window_s: float, directory: Path
) -> dict[str, dict[str, float]]:
    """Return what `compared` says of each kind of n_turns, "graph" and "in_process".

    revision: of the other commit, which is checked out below directory.
    """
    results = {}
    with worktree(revision, directory) as other:
        for kind, n in n_turns.items():
            print(f"measuring {kind} against {revision}: {n} turns", file=sys.stderr, flush=True)
            with worker(ROOT, kind) as ours, worker(other, kind) as theirs:
                results[kind] = compared(*rates_in_turns(ours, theirs, n, window_s))
    return results
