"""Which core a node works on, where there are only two.

Linux likes to wake a thread on the core of whoever wakes it. In a loop of nodes that is the core on
which the sender still has work to do, and the answer waits while the other core is idle.
"""

import os
import re
from pathlib import Path

_N_CORES = 2
_TASKS = Path("/proc/self/task")
# Mesa's software renderer draws with as many threads as there are cores.
_RENDERER = re.compile(r"llvmpipe-(\d+)")


def keep_to_core(i_core: int) -> None:
    """Keep this process to the first (0) or second (1) core; its drawing threads take one each.

    Threads that start later follow the one that starts them. Does nothing where this process may
    use another number of cores than two.
    """
    cores = sorted(os.sched_getaffinity(0))
    if len(cores) != _N_CORES:
        return
    for task in _TASKS.iterdir():
        try:
            drawing = _RENDERER.match((task / "comm").read_text())
            i_own = int(drawing[1]) % _N_CORES if drawing else i_core
            os.sched_setaffinity(int(task.name), {cores[i_own]})
        except (FileNotFoundError, ProcessLookupError):
            continue  # it has ended meanwhile
