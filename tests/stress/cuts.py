"""Runs on two hosts whose network is cut and healed."""

from collections import Counter
from pathlib import Path

import numpy as np

from experiment_manager.run.config_file import CONFIG_FILE
from tests.stress.disturbed_runs import LINE, Found, compared_runs
from tests.stress.supervised_run import SupervisedRun
from tests.stress.two_hosts import NodeOnHost, TwoHosts

_LONGEST_PAUSE_S = 12.0
# Shortest and longest cut of the network.
_CUT_S = (0.1, 45.0)


def cut(directory: Path, n_cuts: int, seeds: np.random.SeedSequence) -> Found:
    """Cut the network between the plant's host and the others' n_cuts times; compare the numbers.

    Raises OSError when this machine cannot make two hosts.
    """
    draw = np.random.default_rng(seeds)
    pauses_s = draw.uniform(0.0, _LONGEST_PAUSE_S, n_cuts)
    # Most are short, and some longer than Fast DDS remembers a silent host.
    lengths_s = np.geomspace(*_CUT_S, n_cuts)
    draw.shuffle(lengths_s)
    done = Counter[str]()
    n_bytes = 0

    def make_run(directory: Path) -> tuple[int, str]:
        nonlocal n_bytes
        config = directory / CONFIG_FILE
        with (
            TwoHosts() as hosts,
            SupervisedRun(LINE, directory, elsewhere=("eye_plant",), prefix=hosts.a.prefix) as run,
        ):
            run.wait_until(config.exists, "the configuration")
            with NodeOnHost(hosts.b, "eye_plant", config):
                run.wait_until(lambda: run.place() >= 0, "the first checkpoint")
                while done.total() < n_cuts and run.pause(pauses_s[done.total()]):
                    hosts.cut()
                    run.pause(lengths_s[done.total()])
                    hosts.heal()
                    done["cut"] += 1
                ended = run.wait(), run.output()
            n_bytes += hosts.n_bytes()
        return ended

    figures, problems = compared_runs(directory, n_cuts, done, make_run)
    own = {
        "cuts": done.total(),
        "longest_s": round(float(lengths_s.max()), 1),
        "megabytes_across": round(n_bytes / 1e6),
    }
    return own | figures, problems
