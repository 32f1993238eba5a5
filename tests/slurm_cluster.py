"""A Slurm cluster of this machine alone, with its own keys, ports and files, for a test."""

import contextlib
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path

import psutil

from lockstep.machine.own_process import die_with
from tests.patience import PATIENCE_S

PARTITION = "main"
_POLL_S = 0.1
# cred_expire: a task that is queued again waits for so long, two minutes by default. The time-outs
# of 100 s are for a busy machine.
_CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket={directory}/munge.socket,cred_expire=20
MessageTimeout=100
BatchStartTimeout=100
KillWait=3
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={directory}/state
SlurmdSpoolDir={directory}/spool
SlurmctldPidFile={directory}/slurmctld.pid
SlurmdPidFile={directory}/slurmd.pid
SlurmctldLogFile={directory}/slurmctld.log
SlurmdLogFile={directory}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,bf_interval=1
MailProg=/bin/true
ReturnToService=2
NodeName={host} NodeAddr=127.0.0.1 CPUs={n_cores} State=UNKNOWN
PartitionName={partition} Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def why_not() -> str:
    """Return why there can be no cluster here, "" when there can."""
    if os.geteuid() != 0:
        return "only root can start Slurm"
    if not all(map(shutil.which, ("munged", "slurmctld", "slurmd", "sbatch"))):
        return "needs the Debian packages munge slurmctld slurmd slurm-client"
    return ""


class Cluster:
    """A munged, a slurmctld and a slurmd."""

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        # Commands find it there.
        self.variables = {"SLURM_CONF": str(directory / "slurm.conf")}

    def call(self, *command: str, check: bool = True) -> str:
        """Return what a command of Slurm's prints; check: that it does what it is told."""
        done = subprocess.run(
            command,
            env=os.environ | self.variables,
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE_S,
        )
        assert done.returncode == 0 or not check, f"{command}: {done.stderr}"
        return done.stdout

    def wait_until(self, condition: Callable[[], bool], what: str) -> None:
        """Wait for a condition."""
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            assert time.monotonic() < end_s, f"waited in vain for {what}:\n{self.logs()}"
            time.sleep(_POLL_S)

    def is_idle(self) -> bool:
        """Return whether the node waits for tasks and none is in the queue."""
        state = self.call("sinfo", "--noheader", "--format=%T", check=False)
        return state.strip() == "idle" and not self.call("squeue", "--noheader")

    def kill_tasks(self) -> None:
        """Kill what a test that failed has left; tasks would outlive the services."""
        for process in psutil.process_iter():
            with contextlib.suppress(psutil.Error):
                if process.environ().items() >= self.variables.items():
                    process.kill()

    def logs(self) -> str:
        """Return what the services have said."""
        return "\n".join(path.read_text() for path in self.directory.glob("*.log"))


@contextmanager
def cluster(n_cores: int) -> Iterator[Cluster]:
    """Start a cluster of so many cores, and stop it."""
    with ExitStack() as stack:
        # Not below pytest's directory: munge wants its socket where everybody may look.
        temporary = tempfile.TemporaryDirectory(prefix="slurm_", ignore_cleanup_errors=True)
        directory = Path(stack.enter_context(temporary))
        directory.chmod(0o755)
        started = Cluster(directory)
        stack.callback(started.kill_tasks)
        _configure(directory, n_cores)

        def serve(*command: str) -> None:
            log = stack.enter_context((directory / f"{command[0]}_output.log").open("wb"))
            process = subprocess.Popen(
                command,
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                preexec_fn=partial(die_with, os.getpid()),  # noqa: PLW1509 (it calls the kernel only)
            )
            stack.enter_context(process)
            stack.callback(process.kill)

        files = ("socket", "key-file", "pid-file", "log-file", "seed-file")
        munge = [f"--{name}={directory}/munge.{name.removesuffix('-file')}" for name in files]
        serve("munged", "--foreground", *munge)
        started.wait_until((directory / "munge.socket").exists, "munge")
        serve("slurmctld", "-i", "-D", "-f", started.variables["SLURM_CONF"])
        serve("slurmd", "-D", "-f", started.variables["SLURM_CONF"])
        started.wait_until(started.is_idle, "an idle node")
        yield started


def _configure(directory: Path, n_cores: int) -> None:
    with socket.socket() as one, socket.socket() as other:
        for free in (one, other):
            free.bind(("127.0.0.1", 0))
        ports = [free.getsockname()[1] for free in (one, other)]
    key = directory / "munge.key"
    key.touch(mode=0o600)
    key.write_bytes(os.urandom(1024))
    for name in ("state", "spool"):
        (directory / name).mkdir()
    (directory / "cgroup.conf").write_text("CgroupAutomount=no\nConstrainCores=no\n")
    host = socket.gethostname().partition(".")[0]
    (directory / "slurm.conf").write_text(
        _CONFIGURATION.format(
            host=host, directory=directory, ports=ports, n_cores=n_cores, partition=PARTITION
        )
    )
