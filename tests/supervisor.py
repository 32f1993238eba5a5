"""The supervisor of a run as a process, and a node without one, for tests and tools."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path
from typing import IO, Any

from lockstep.machine.own_process import die_with
from tests.patience import PATIENCE_S


def environment() -> dict[str, str]:
    """Return the environment of a graph: the user's domain is none of its business."""
    return {k: v for k, v in os.environ.items() if k != "ROS_DOMAIN_ID"}


def started(
    command: Sequence[str | Path],
    variables: Mapping[str, str] | None = None,
    output: int | IO[str] = subprocess.PIPE,
    **options: Any,
) -> "subprocess.Popen[str]":
    """Start a process outside the user's ROS domain; what it says is one stream, the output.

    variables: more of its environment; options: of Popen.
    """
    return subprocess.Popen(
        command,
        env=environment() | dict(variables or {}),
        stdin=subprocess.DEVNULL,
        stdout=output,
        stderr=subprocess.STDOUT,
        text=True,
        **options,
    )


def start_supervisor(
    line: Sequence[str],
    *,
    prefix: Sequence[str] = (),
    variables: Mapping[str, str] | None = None,
    output: int | IO[str] = subprocess.PIPE,
) -> "subprocess.Popen[str]":
    """Start a supervisor that ends with this process; variables, output: as `started` has them.

    line: the command line of run_experiment.sh; prefix: a command that becomes the one that follows
    it, such as env or prlimit.
    """
    return started(
        [
            *prefix,
            sys.executable,
            "-m",
            "active_binocular_vision.command_lines.run",
            *line,
        ],
        variables,
        output,
        preexec_fn=partial(die_with, os.getpid()),
    )


def finished(process: "subprocess.Popen[str]", code: int = 0) -> str:
    """Wait for the end of a process with that exit code; return what it printed."""
    try:
        output, _ = process.communicate(timeout=PATIENCE_S)
    finally:
        process.kill()
    assert process.returncode == code, f"exit code {process.returncode}:\n{output}"
    return output


class LoneNode(AbstractContextManager["LoneNode"]):
    """The process of a node that somebody starts without a supervisor, killed after the block."""

    def __init__(
        self, package: str, config: Path, domain: int, log: Path, prefix: Sequence[str] = ()
    ) -> None:
        """config: the run's config.yaml, or a copy; prefix: a command that becomes the node."""
        node = [sys.executable, "-m", f"{package}.node", "--ros-args", "--params-file", str(config)]
        variables = {"ROS_DOMAIN_ID": str(domain), "PYTHONUNBUFFERED": "1"}
        with log.open("a") as output:
            self.process = started(
                [*prefix, *node], variables, output, preexec_fn=partial(die_with, os.getpid())
            )

    def __exit__(self, *exception: object) -> None:
        """End the node."""
        self.process.kill()
        self.process.wait(PATIENCE_S)
