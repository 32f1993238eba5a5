"""One commit's windows, for against.py: run by its path, with that commit's packages to import.

It prints "ready", and for each line, a duration in s, on its input the rate of a window, in
iterations/s. The loop in one process stands still in between; a new graph is started for each.
"""

import contextlib
import itertools
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.command_lines import configured

ARGUMENTS = ["--profile", "paper", "--iterations", "1000000", "--tests", "1000000"]
WARM_UP_ITERATIONS = 300


def main() -> None:
    """Measure windows until the input ends; the only argument is "graph" or "in_process"."""
    line = ARGUMENTS
    try:
        graph: Any = __import__("tools.benchmark.graph", fromlist=["graph"])
        loop: Any = __import__("tools.benchmark.loop", fromlist=["loop"])
        rate_hz: Any = graph.rate_hz
    except ModuleNotFoundError:  # a commit whose benchmark was among the tests
        graph = __import__("tests.benchmark.graph", fromlist=["graph"])
        loop = __import__("tests.benchmark.loop", fromlist=["loop"])
        rate_hz = __import__("tests.benchmark.samples", fromlist=["samples"]).rate_hz
        line = [*ARGUMENTS, "--set", "eye_plant.camera.renderer=plane"]
    with tempfile.TemporaryDirectory(prefix="benchmark-") as temporary:
        if sys.argv[1] == "in_process":
            timed = loop.TimedLoop(configured(*line))
            timed.window(1.0)
        print("ready", flush=True)
        for number, duration in zip(itertools.count(), sys.stdin, strict=False):
            if sys.argv[1] == "in_process":
                rate = timed.window(float(duration)).rate_hz
            else:
                directory = Path(temporary) / f"run_{number}"
                with graph.supervised_run(line, directory) as running:
                    running.await_start(WARM_UP_ITERATIONS)
                    rate = rate_hz(running.window(float(duration)))
            print(rate, flush=True)


if __name__ == "__main__":
    with contextlib.suppress(KeyboardInterrupt):
        main()
