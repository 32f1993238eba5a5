"""Runs on two hosts whose network is cut and healed."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.run.config_file import CONFIG_FILE
from lockstep.errors import InputError
from tests.stress.supervised_run import SupervisedRun, n_messages, problems_of, undisturbed
from tests.stress.two_hosts import NodeOnHost, TwoHosts

_LONGEST_PAUSE_S = 12.0
# Shortest and longest cut of the network.
_CUT_S = (0.1, 45.0)


def cut(
    line: Sequence[str], directory: Path, n_cuts: int, draw: np.random.Generator
) -> tuple[dict[str, Any], list[str]]:
    """Cut the network between the plant's host and the others' until n_cuts; compare the numbers.

    Returns the figures and what went wrong. Raises InputError when this machine cannot make two
    hosts.
    """
    reference = undisturbed(line, directory / "one_host")
    pauses_s = draw.uniform(0.0, _LONGEST_PAUSE_S, n_cuts)
    # Most are short, and some longer than Fast DDS remembers a silent host.
    lengths_s = np.geomspace(*_CUT_S, n_cuts)
    draw.shuffle(lengths_s)
    cuts_s = list(zip(pauses_s.tolist(), lengths_s.tolist(), strict=True))
    problems: list[str] = []
    n_runs = n_bytes = 0
    while cuts_s and not problems:
        across = directory / f"two_hosts_{n_runs}"
        n_runs += 1
        try:
            with TwoHosts() as hosts:
                ended = _cut_run(hosts, line, across, cuts_s)
                n_bytes += hosts.n_bytes()
        except OSError as error:
            raise InputError(
                f"two hosts need root, and ip, unshare and nsenter: {error}"
            ) from error
        problems += problems_of(across, reference, *ended)
        print(f"run {n_runs}: {n_cuts - len(cuts_s)} of {n_cuts} cuts, {problems or 'all held'}")
    figures = {
        "cuts": n_cuts - len(cuts_s),
        "longest_s": round(float(lengths_s.max()), 1),
        "runs": n_runs,
        "megabytes_across": round(n_bytes / 1e6),
        "messages_compared": n_runs * n_messages(reference),
    }
    return figures, problems


def _cut_run(
    hosts: TwoHosts, line: Sequence[str], directory: Path, cuts_s: list[tuple[float, float]]
) -> tuple[int, str]:
    """Make one run under cuts, (time before, length), and take these away; return code, output."""
    with SupervisedRun(line, directory, elsewhere=("eye_plant",), prefix=hosts.a.prefix) as run:
        run.wait_until((directory / CONFIG_FILE).exists, "the configuration")
        with NodeOnHost(hosts.b, "eye_plant", directory / CONFIG_FILE):
            run.wait_until(lambda: run.place() >= 0, "the first checkpoint")
            while cuts_s:
                pause_s, length_s = cuts_s[-1]
                run.pause(pause_s)
                if run.process.poll() is not None:
                    break
                cuts_s.pop()
                hosts.cut()
                run.pause(length_s)
                hosts.heal()
            return run.wait(), run.output()
