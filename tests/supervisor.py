"""The supervisor of a run as a process, for tests, benchmarks and stress."""

import os
import subprocess
import sys
from collections.abc import Mapping, Sequence
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
        [*prefix, sys.executable, "-m", "active_binocular_vision.commands.run_experiment", *line],
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
