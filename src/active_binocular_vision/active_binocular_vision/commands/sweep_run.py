"""One run of a sweep, as its child, which does not outlive it: PARENT DIRECTORY.

PARENT: the number of the process that started it; DIRECTORY: of the run, which goes on if it has
begun; else the sweep's file beside it says what it is.
"""

import sys
from pathlib import Path
from typing import NoReturn

from active_binocular_vision.commands.run import (
    check_old,
    concluded,
    in_one_process,
    prepare_new,
)
from experiment_manager import RunRequest
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.sweep.sweep_file import SWEEP_FILE, read_sweep
from lockstep.machine.lasting_output import ignore_broken_pipes
from lockstep.machine.own_process import die_with


def _run(directory: Path) -> tuple[Path, int]:
    if (directory / CONFIG_FILE).exists():
        check_old(directory, RunRequest())
    else:
        # A kill may have left the directory, and a configuration half-written, but no more.
        (directory / f"{CONFIG_FILE}.part").unlink(missing_ok=True)
        prepare_new(read_sweep(directory.parent / SWEEP_FILE).runs()[directory.name], directory)
    return in_one_process(directory)


def main() -> NoReturn:
    """Make the run, and exit with its code."""
    parent, path = sys.argv[1:]
    die_with(int(parent))
    ignore_broken_pipes()
    sys.exit(concluded(lambda: _run(Path(path)), " --in-process"))
