"""Work on many runs at once: a process for each core."""

import os
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from typing import TypeVar

from lockstep.machine.progress_lines import progress

R = TypeVar("R")
T = TypeVar("T")


def of_each_run(work: Callable[[R], T], runs: Sequence[R], name: str) -> list[T]:
    """Return what a function of a module returns for each run, in order.

    name: of the work, for the progress on standard error. Raises what the function raises.
    """
    shown = partial(progress, file=sys.stderr, desc=name, unit="run", total=len(runs))
    n_processes = min(len(runs), len(os.sched_getaffinity(0)))
    if n_processes == 1:  # another process would first import all that this one has
        return list(shown(map(work, runs)))
    with ProcessPoolExecutor(n_processes, get_context("spawn")) as processes:
        return list(shown(processes.map(work, runs)))
