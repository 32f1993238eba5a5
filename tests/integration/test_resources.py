"""A run that lacks something: a clear end or a clean wait, and nothing half-written."""

import contextlib
import os
import pty
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest

from experiment_manager import Bag
from tests.graph_harness import write_configuration
from tests.loop_contract import assert_as_the_loop, run_line
from tests.patience import PATIENCE_S
from tests.supervised_run import SupervisedRun, is_intact, n_messages, stamp_faults
from tests.supervisor import start_supervisor

pytestmark = pytest.mark.graph


@pytest.fixture(scope="module")
def line(pictures: Path) -> list[str]:
    """Return the command line of a run with a checkpoint five times a second."""
    return run_line(pictures)


class Disk:
    """A file system in memory of its own, which only processes with the prefix see in its place.

    root: where it is seen from here.
    """

    def __init__(self, place: Path, options: str) -> None:
        place.mkdir()
        mount = 'mount -t tmpfs -o "$0" tmpfs "$1" && echo ready && exec cat'
        self._anchor = subprocess.Popen(
            ["unshare", "--mount", "--propagation=private", "sh", "-c", mount, options, place],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
        assert self._anchor.stdout is not None
        said = self._anchor.stdout.readline().strip()
        if said != "ready":
            self.close()
            pytest.skip(f"a disk of one's own needs root: {said}")
        self.prefix = ("nsenter", f"--target={self._anchor.pid}", "--mount", "--")
        self.root = Path(f"/proc/{self._anchor.pid}/root{place}")

    def fill(self) -> Path:
        """Write a file that takes all the space there is."""
        ballast = self.root / "ballast"
        with ballast.open("wb", buffering=0) as file, contextlib.suppress(OSError):
            while True:
                file.write(bytes(1 << 12))
        return ballast

    def close(self) -> None:
        self._anchor.communicate(timeout=PATIENCE_S)


def test_a_full_disk(line: list[str], tmp_path: Path) -> None:
    with closing(Disk(tmp_path / "run", "size=32m")) as disk:
        with SupervisedRun(line, disk.root, prefix=disk.prefix) as run:
            assert run.wait_until(lambda: run.place() >= 4, "a checkpoint")
            ballast = disk.fill()
            assert run.wait() == 3, run.output()
            output = run.output()
        assert output.count("error: ") == 1, output
        assert "fault: " not in output
        assert "cannot be written: [Errno 28] No space left on device" in output
        assert " run --resume " in output
        assert not list(disk.root.rglob("*.part"))
        assert is_intact(disk.root)
        # The file that was cut off can be read as far as it goes.
        n_whole = len(Bag(disk.root / "bag").stamps_ns("episode"))
        assert n_whole > 4 * 11
        ballast.unlink()
        with SupervisedRun(
            line, disk.root, resume=True, in_process=True, prefix=disk.prefix
        ) as run:
            assert run.wait() == 0, run.output()
        assert_as_the_loop(disk.root)


@pytest.mark.parametrize("resume", [False, True])
def test_a_disk_that_may_only_be_read(line: list[str], tmp_path: Path, resume: bool) -> None:
    with closing(Disk(tmp_path / "run", "size=1m")) as disk:
        if resume:
            write_configuration(disk.root / "config.yaml", line)
        subprocess.run(
            [*disk.prefix, "mount", "-o", "remount,ro", tmp_path / "run"],
            check=True,
            timeout=PATIENCE_S,
        )
        with SupervisedRun(line, disk.root, resume=resume, prefix=disk.prefix) as run:
            assert run.wait() == 2
            output = run.output()
    assert output.count("error: ") == 1, output
    assert "Traceback" not in output
    assert "/run: cannot be written: [Errno 30] Read-only file system" in output


def test_a_node_without_memory(line: list[str], tmp_path: Path) -> None:
    """With weights of half a petabyte: a limit set from outside would hit Fast DDS, which may hang.

    What a shortage in ROS looks like, lockstep/node/test_process.py tests.
    """
    directory = tmp_path / "run"
    n_hidden = 10**12
    with SupervisedRun(
        [*line, "--set", f"vergence_rl.cacla.n_hidden={n_hidden}"], directory
    ) as run:
        assert run.wait() == 3, run.output()
        output = run.output()
    assert output.count("fault: vergence_rl ended: ") == 3, output
    assert output.count("error: ") == 1, output
    assert "before the first checkpoint" in output
    assert "Unable to allocate" in output
    assert not (directory / "results.json").exists()


# Becomes the command that follows the terminal's name, alone in that terminal.
IN_TERMINAL = """
import os, signal, sys

signal.signal(signal.SIGHUP, signal.SIG_DFL)  # the tests themselves may run under nohup
os.setsid()
terminal = os.open(sys.argv[1], os.O_RDWR)
for number in range(3):
    os.dup2(terminal, number)
os.execvp(sys.argv[2], sys.argv[2:])
"""


def test_a_terminal_that_is_closed_and_a_reader_that_leaves(line, tmp_path) -> None:
    directory = tmp_path / "run"
    ours, theirs = pty.openpty()
    prefix = (sys.executable, "-c", IN_TERMINAL, os.ttyname(theirs))
    with SupervisedRun(line, directory, prefix=prefix) as run:
        assert run.wait_until(lambda: run.place() >= 4, "a checkpoint")
        assert b"run directory: " in os.read(ours, 4096)
        os.close(theirs)
        os.close(ours)
        # As after Ctrl-C: the episode under way is ended, a checkpoint made.
        assert run.wait() == 130
    assert is_intact(directory)
    assert stamp_faults(directory) == []
    assert n_messages(directory) > 0
    assert not (directory / "results.json").exists()
    # And one that speaks to a pipe, whose reader leaves at once.
    resumed = start_supervisor(["--resume", str(directory), "--in-process"])
    assert resumed.stdout is not None
    resumed.stdout.close()
    try:
        assert resumed.wait(PATIENCE_S) == 0
    finally:
        resumed.kill()
    assert_as_the_loop(directory)
