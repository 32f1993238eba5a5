"""Runs that are disturbed on purpose: nodes killed or stopped, and what the bag then holds."""

import contextlib
import os
import signal
import time
from collections.abc import Callable, Collection, Sequence
from contextlib import AbstractContextManager
from pathlib import Path

import msgspec
import numpy as np
import psutil

from experiment_manager import Bag
from experiment_manager.measures.results import RESULTS_FILE, read_results
from experiment_manager.nodes import NODES
from experiment_manager.run import checkpoint
from experiment_manager.run.recorded_topics import SMALL_TOPICS
from tests.patience import PATIENCE_S
from tests.supervisor import start_supervisor

_POLL_S = 0.02
_BYTES_PER_MB = 1 << 20


class SupervisedRun(AbstractContextManager["SupervisedRun"]):
    """A supervisor as a process of its own, and its nodes."""

    def __init__(
        self,
        line: Sequence[str],
        directory: Path,
        *,
        resume: bool = False,
        in_process: bool = False,
        elsewhere: Sequence[str] = (),
        prefix: Sequence[str] = (),
    ) -> None:
        """line: the command line of run_experiment.sh without --out, --resume and --elsewhere.

        elsewhere: nodes that somebody else starts. prefix: a command that becomes the one that
        follows it, such as env or prlimit.
        """
        self.directory = directory
        where = ["--resume", str(directory)] if resume else [*line, "--out", str(directory)]
        if in_process:
            where.append("--in-process")
        if elsewhere:
            where += ["--elsewhere", ",".join(elsewhere)]
        self._log = directory.with_name(directory.name + ".log").open("a+")
        self.process = start_supervisor(where, prefix=prefix, output=self._log)

    def __exit__(self, *exception: object) -> None:
        """Kill the supervisor, and with it its nodes."""
        self.process.kill()
        self.process.wait(PATIENCE_S)
        self._log.close()

    def nodes(self) -> dict[str, int]:
        """Return the process ids of the nodes that are there now, by package."""
        found: dict[str, int] = {}
        with contextlib.suppress(psutil.NoSuchProcess):
            for child in psutil.Process(self.process.pid).children():
                with contextlib.suppress(psutil.NoSuchProcess):
                    words = child.cmdline()
                    found |= {p: child.pid for p in NODES if f"{p}.node" in words}
        return found

    def place(self) -> int:
        """Return how many episodes the newest checkpoint holds, -1 without one."""
        manifests = sorted((self.directory / "checkpoints").glob("*/manifest.json"))
        return int(manifests[-1].parent.name) if manifests else -1

    def wait_until(self, condition: Callable[[], bool], what: str) -> bool:
        """Wait for a condition; return False when the run ended first.

        Raises TimeoutError when neither comes.
        """
        end_s = time.monotonic() + PATIENCE_S
        while not condition():
            if self.process.poll() is not None:
                return False
            if time.monotonic() > end_s:
                raise TimeoutError(f"waited {PATIENCE_S} s in vain for {what}:\n{self.output()}")
            time.sleep(_POLL_S)
        return True

    def pause(self, duration_s: float) -> bool:
        """Wait for so long; return False when the run ended first."""
        end_s = time.monotonic() + duration_s
        return self.wait_until(lambda: time.monotonic() >= end_s, "the pause")

    def wait(self) -> int:
        """Wait for the end of the run; return its exit code."""
        self.wait_until(lambda: False, "the end of the run")
        return self.process.wait(PATIENCE_S)

    def kill(self) -> None:
        """Kill the supervisor; raise RuntimeError when its nodes outlive it."""
        nodes = self.nodes().values()
        self.process.kill()
        self.process.wait(PATIENCE_S)
        if not are_gone(nodes):
            raise RuntimeError(f"nodes outlive their supervisor: {nodes}")

    def signal_node(self, package: str, number: signal.Signals) -> bool:
        """Send a signal to a node; return False when it was not there any more."""
        process_id = self.nodes().get(package)
        if process_id is None:
            return False
        try:
            os.kill(process_id, number)
        except ProcessLookupError:
            return False
        return True

    def output(self) -> str:
        """Return what the supervisor has said, in all its lives."""
        return Path(self._log.name).read_text(errors="replace")


def interrupted_and_resumed(
    line: Sequence[str], directory: Path, *, begins_in_process: bool
) -> None:
    """Begin a run in one process or as a graph, interrupt it, and end it the other way."""
    with SupervisedRun(line, directory, in_process=begins_in_process) as run:
        assert run.wait_until(lambda: run.place() >= 2, "a checkpoint")
        run.process.send_signal(signal.SIGINT)
        assert run.wait() == 130, run.output()
        assert "stopping after this episode, with a checkpoint" in run.output()
        option = " --in-process" if begins_in_process else ""
        assert f" run --resume {directory}{option}\n" in run.output()
        stopped_at = run.place()
    assert not (directory / "results.json").exists()
    with SupervisedRun(line, directory, resume=True, in_process=not begins_in_process) as run:
        assert run.wait() == 0, run.output()
        assert run.place() > stopped_at


def is_alive(process_id: int) -> bool:
    """Return whether a process exists and is more than the record of its end."""
    try:
        state = psutil.Process(process_id).status()
    except psutil.NoSuchProcess:
        return False
    return state not in (psutil.STATUS_ZOMBIE, psutil.STATUS_DEAD)


def memory_mb(process_id: int) -> float:
    """Return the resident memory of a process; raises psutil.NoSuchProcess."""
    return float(psutil.Process(process_id).memory_info().rss) / _BYTES_PER_MB


def are_gone(process_ids: Collection[int]) -> bool:
    """Wait for the end of processes that are not our children; return whether it came."""
    end_s = time.monotonic() + PATIENCE_S
    while any(is_alive(process_id) for process_id in process_ids):
        if time.monotonic() > end_s:
            return False
        time.sleep(_POLL_S)
    return True


def differences(one: Path, other: Path) -> list[str]:
    """Compare the small messages of two runs bit for bit; return what differs."""
    first, second = (Bag(path / "bag").vectors(*SMALL_TOPICS) for path in (one, other))
    found = []
    for topic in SMALL_TOPICS:
        for field in ("stamps_ns", "position", "velocity", "effort"):
            a, b = getattr(first[topic], field), getattr(second[topic], field)
            if a.shape != b.shape:
                found.append(f"{topic}.{field}: {a.shape} and {b.shape}")
            elif a.tobytes() != b.tobytes():
                rows = np.flatnonzero((a != b).reshape(len(a), -1).any(axis=1))
                found.append(f"{topic}.{field}: {len(rows)} rows from row {rows[:1]}")
    results = [
        msgspec.structs.replace(read_results(path / RESULTS_FILE), commit="")
        for path in (one, other)
    ]
    if results[0] != results[1]:
        found.append(RESULTS_FILE)
    return found


def n_messages(directory: Path) -> int:
    """Return how many small messages the bag of a run holds."""
    tables = Bag(directory / "bag").vectors(*SMALL_TOPICS)
    return sum(len(table.stamps_ns) for table in tables.values())


def stamp_faults(directory: Path) -> list[str]:
    """Return which topics of a run lack a stamp or have one twice."""
    tables = Bag(directory / "bag").vectors(*SMALL_TOPICS)
    episodes = tables["episode"]
    found = []
    numbers = episodes.column("observation")
    if not np.array_equal(numbers, np.arange(len(numbers))):
        found.append("episode: the observations are not numbered through")
    is_last = np.append(np.diff(episodes.column("iteration")) <= 0, True)
    for topic, table in tables.items():
        answers = topic in ("reward", "muscle_command", "actor_critic")
        expected = episodes.stamps_ns[~is_last] if answers else episodes.stamps_ns
        if not np.array_equal(table.stamps_ns, expected):
            found.append(f"{topic}: {len(table.stamps_ns)} stamps, expected {len(expected)}")
    return found


def is_intact(directory: Path) -> bool:
    """Return whether the newest checkpoint of a run is one, and whole."""
    return checkpoint.newest(directory / "checkpoints") is not None
