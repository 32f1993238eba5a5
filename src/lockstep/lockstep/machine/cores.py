"""How nodes share a machine of only two cores.

Linux likes to wake a thread on the core of whoever wakes it. In a loop of nodes that is the core on
which the sender still has work to do, and the answer waits while the other core is idle. And each
message wakes the middleware's threads of all who hear it, and with its receipt those of the sender:
they interrupt whoever is at work on that core, some thirty times in an iteration.
"""

import os
from contextlib import suppress
from pathlib import Path

_N_CORES = 2
_TASKS = Path("/proc/self/task")


def share_two_cores(i_core: int, *, gives_way: bool) -> None:
    """Keep this process to the first (0) or second (1) core.

    gives_way: its threads wait for a free core rather than interrupt another thread (SCHED_BATCH);
    their share of a busy machine stays the same. Threads that start later follow the one that
    starts them. Does nothing where this process may use another number of cores than two, and
    leaves out what a sandbox or a container does not allow.
    """
    cores: list[int] = []
    with suppress(OSError):
        cores = sorted(os.sched_getaffinity(0))
    if len(cores) != _N_CORES or not _TASKS.is_dir():
        return
    for number in [int(task.name) for task in _TASKS.iterdir()]:
        # It only makes a run quicker; besides, a thread may have ended meanwhile.
        with suppress(OSError):
            os.sched_setaffinity(number, {cores[i_core]})
        with suppress(OSError):
            if gives_way and os.sched_getscheduler(number) == os.SCHED_OTHER:
                os.sched_setscheduler(number, os.SCHED_BATCH, os.sched_param(0))
