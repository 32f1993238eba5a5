"""The runs of a sweep as one job array of a Slurm cluster.

A task goes on by itself: Slurm starts it again after a requeue, and when its time limit is near it
asks for one itself, from a checkpoint.
"""

import os
import re
import shlex
import shutil
import signal
import subprocess
from collections.abc import Sequence
from pathlib import Path

from experiment_manager.sweep.pool import Pool
from experiment_manager.sweep.sweep_run import SweepRun
from lockstep import InputError
from lockstep.exit_codes import EXIT_INTERRUPTED

# Slurm looks at time limits once in a minute; an episode and a checkpoint take seconds.
_WARNING_S = 120
_PREFIX = re.compile(r"^sbatch: (error|fatal): ")


def check(resources: Sequence[str]) -> None:
    """Ask Slurm whether it would take tasks of such options; raises InputError in its words."""
    _sbatch([*resources, "--test-only", "--wrap", "true"])


def submit(directory: Path, array: str, task: Sequence[str], resources: Sequence[str]) -> str:
    """Submit runs of a sweep's directory as one array; return the number of the job.

    array: numbers of the runs, in sbatch's notation; task: command line of a run without its last
    argument, the number; resources: sbatch's options. Raises InputError for what Slurm refuses, in
    its words.
    """
    (directory / "logs").mkdir(exist_ok=True)
    # The script becomes the process of the task, so that Slurm's signal reaches it.
    script = f'exec {shlex.join(task)} "$SLURM_ARRAY_TASK_ID"'
    options = [
        *resources,
        f"--array={array}",
        f"--job-name={directory.name}",
        "--cpus-per-task=1",
        "--export=ALL",
        "--requeue",
        "--open-mode=append",
        f"--signal=B:USR1@{_WARNING_S}",
        f"--chdir={directory}",
        # Where % is one of a directory's own, Slurm wants it twice.
        f"--output={str(directory / 'logs').replace('%', '%%')}/slurm_%a.out",
    ]
    return _sbatch([*options, "--parsable", "--wrap", script]).partition(";")[0].strip()


def run_task(run: SweepRun, start: Sequence[str]) -> int:
    """Make one run as a task of Slurm; return the exit code of the task.

    Warned of the end of its time, it stops with a checkpoint and asks to be queued again.
    start: as of `SweepRun.make`.
    """
    pool = Pool(1, start)
    warnings: list[int] = []

    def warned(number: int, frame: object) -> None:
        warnings.append(number)
        signal.raise_signal(signal.SIGINT)

    signal.signal(signal.SIGUSR1, warned)
    code = pool.run([run])
    if warnings and run.exit_code == EXIT_INTERRUPTED and not run.is_done:
        task = f"{os.environ['SLURM_ARRAY_JOB_ID']}_{os.environ['SLURM_ARRAY_TASK_ID']}"
        subprocess.run(["scontrol", "requeue", task], check=False)
    return code


def _sbatch(options: Sequence[str]) -> str:
    if shutil.which("sbatch") is None:
        raise InputError("--slurm: expected sbatch on this machine, found none")
    done = subprocess.run(["sbatch", *options], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = [_PREFIX.sub("", line) for line in done.stderr.splitlines()]
        raise InputError(f"--slurm: {'; '.join(lines) or f'exit code {done.returncode}'}")
    return done.stdout
