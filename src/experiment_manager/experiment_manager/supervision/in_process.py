"""Brings a run to its end in this process, as the supervisor does with nodes."""

import sys
from pathlib import Path

from experiment_manager.run.config_file import CONFIG_FILE, read_configuration
from experiment_manager.run.in_process import InProcessRun
from experiment_manager.supervision.attempt import goes_on
from lockstep.errors import DivergenceError, InputError
from lockstep.exit_codes import EXIT_FAULT, EXIT_INTERRUPTED
from lockstep.machine.interrupts import Interrupts


def run_in_process(directory: Path) -> int:
    """Return the exit code: 0 done, 3 a fault, 130 interrupted.

    directory: holds config.yaml, and whatever the run has done so far. What is wrong here would be
    so again, so nothing is tried twice. Raises InputError for what cannot be begun.
    """
    interrupts = Interrupts()
    run: InProcessRun | None = None
    try:
        configuration = read_configuration(directory / CONFIG_FILE)
        run = InProcessRun(configuration, directory, interrupts, resume=goes_on(directory))
        is_over = run.go_on()
        run.close()
    except OSError as error:
        reason = f"{directory} cannot be written: {error}; what was saved before is whole"
        print(f"error: {reason}", file=sys.stderr)
        return EXIT_FAULT
    except DivergenceError as error:
        print(f"error: {error}; what was saved before is whole", file=sys.stderr)
        return EXIT_FAULT
    except InputError as error:
        if run is None:
            raise
        print(f"error: {error}", file=sys.stderr)
        return EXIT_FAULT
    return 0 if is_over else EXIT_INTERRUPTED
