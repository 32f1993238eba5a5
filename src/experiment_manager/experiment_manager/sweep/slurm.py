"""The cells of a sweep as one job array of a Slurm cluster.

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
from dataclasses import dataclass
from pathlib import Path

from experiment_manager.sweep.cell_run import CellRun
from lockstep import InputError
from lockstep.exit_codes import EXIT_INTERRUPTED
from lockstep.machine.interrupts import Interrupts

_JOB_FILE = "slurm_job"
# Slurm looks at time limits once in a minute; an episode and a checkpoint take seconds.
_WARNING_S = 120
_PREFIX = re.compile(r"^sbatch: (error|fatal): ")
_SCRIPT = Path("launch_scripts/sweep.sh")


@dataclass(frozen=True)
class Resources:
    """What a task asks for, as sbatch's options of these names have it; "" leaves it to Slurm.

    tasks: at most so many at a time, None is no limit.
    """

    partition: str = ""
    time: str = ""
    memory: str = ""
    tasks: int | None = None

    def options(self) -> list[str]:
        """Return sbatch's options."""
        given = {"--partition": self.partition, "--time": self.time, "--mem": self.memory}
        return [f"{name}={value}" for name, value in given.items() if value]


def check(resources: Resources) -> None:
    """Ask Slurm whether it would take such tasks; raises InputError with its words if not."""
    _sbatch([*resources.options(), "--test-only", "--wrap", "true"])


def submit(
    directory: Path, runs: Sequence[CellRun], indices: Sequence[int], resources: Resources
) -> str:
    """Submit runs of a sweep's directory as one array, task numbers being the runs' indices.

    Returns the number of the job. Raises InputError when its last job is still in the queue, and
    in Slurm's words for whatever it refuses.
    """
    refuse_queued(directory)
    (directory / "logs").mkdir(exist_ok=True)
    array = ",".join(str(i) for i in indices)
    if resources.tasks is not None:
        array += f"%{resources.tasks}"
    root = next(path for path in Path(__file__).resolve().parents if (path / _SCRIPT).exists())
    command = ["exec", str(root / _SCRIPT), str(directory), "--task"]
    # The script becomes the process of the task, so that Slurm's signal reaches it.
    script = f'{shlex.join(command)} "$SLURM_ARRAY_TASK_ID"'
    options = [
        *resources.options(),
        f"--array={array}",
        f"--job-name={directory.name}",
        "--cpus-per-task=1",
        "--requeue",
        "--open-mode=append",
        f"--signal=B:USR1@{_WARNING_S}",
        f"--chdir={directory}",
        f"--output={directory / 'logs' / 'slurm_%a.out'}",
    ]
    job = _sbatch([*options, "--parsable", "--wrap", script]).partition(";")[0].strip()
    (directory / _JOB_FILE).write_text(f"{job}\n")
    return job


def refuse_queued(directory: Path) -> None:
    """Raise InputError when the sweep's last job still has tasks that wait or run."""
    path = directory / _JOB_FILE
    if not path.exists() or shutil.which("squeue") is None:
        return
    job = path.read_text().strip()
    found = subprocess.run(
        ["squeue", "--noheader", f"--jobs={job}"], capture_output=True, text=True, check=False
    )
    # Of a job that it has forgotten, squeue says that its number is invalid.
    if found.returncode == 0 and found.stdout.strip():
        raise InputError(
            f"{directory}: expected no job of this sweep in the queue, {job} is; "
            f"scancel {job} removes it"
        )


def run_task(run: CellRun) -> int:
    """Make one run as a task of Slurm; return the exit code of the task.

    Warned of the end of its time, it stops with a checkpoint and asks to be queued again.
    """
    task = _Task()
    code = run.run(task.started)
    if code is None:
        raise InputError(f"{run.directory}: another process is making it")
    if task.is_warned and not run.is_done and code == EXIT_INTERRUPTED:
        environment = os.environ
        number = f"{environment['SLURM_ARRAY_JOB_ID']}_{environment['SLURM_ARRAY_TASK_ID']}"
        subprocess.run(["scontrol", "requeue", number], check=False)
    return code


class _Task:
    """Passes the signals of Slurm to its task on to a run."""

    def __init__(self) -> None:
        self.is_warned = False
        self._process: subprocess.Popen[bytes] | None = None
        self._interrupts = Interrupts(self._stop)
        signal.signal(signal.SIGUSR1, lambda number, frame: self._warn())

    def started(self, process: "subprocess.Popen[bytes]") -> None:
        self._process = process
        if self.is_warned or self._interrupts.count:
            self._stop()

    def _warn(self) -> None:
        self.is_warned = True
        self._stop()

    def _stop(self) -> None:
        if self._process is not None and self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)


def _sbatch(options: Sequence[str]) -> str:
    if shutil.which("sbatch") is None:
        raise InputError("--slurm: expected sbatch on this machine, found none")
    done = subprocess.run(["sbatch", *options], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        lines = [_PREFIX.sub("", line) for line in done.stderr.splitlines()]
        raise InputError(f"--slurm: {'; '.join(lines) or f'exit code {done.returncode}'}")
    return done.stdout
