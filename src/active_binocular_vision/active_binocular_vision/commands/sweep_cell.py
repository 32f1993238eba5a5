"""One run of a sweep, as its child, which does not outlive it: PARENT DIRECTORY REQUEST.

PARENT: the number of the process that started it; DIRECTORY: of the run, which goes on if it has
begun; REQUEST: `RunRequest.to_json`, for a run that has not.
"""

import sys
from pathlib import Path

from active_binocular_vision.commands.run_experiment import (
    check_old,
    concluded,
    in_one_process,
    prepare_new,
)
from experiment_manager.preparation.request import RunRequest
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.terminal.lasting_output import ignore_broken_pipes
from lockstep.machine.own_process import die_with


def make_run(directory: Path, document: str) -> int:
    """Begin a run or go on with it; return the exit code."""
    return concluded(lambda: _run(directory, document), " --in-process")


def _run(directory: Path, document: str) -> tuple[Path, int]:
    if (directory / CONFIG_FILE).exists():
        check_old(directory, RunRequest())
    else:
        prepare_new(RunRequest.from_json(document), directory)
    return in_one_process(directory)


if __name__ == "__main__":
    parent, path, request = sys.argv[1:]
    die_with(int(parent))
    ignore_broken_pipes()
    sys.exit(make_run(Path(path), request))
