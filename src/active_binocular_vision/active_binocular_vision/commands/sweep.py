"""Many runs that differ in a few options, in one command, on one machine or a cluster."""

import argparse
import os
import shlex
import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from active_binocular_vision.command_lines.sweep import parser
from active_binocular_vision.commands.run import source_commit
from experiment_manager import RunRequest, configuration_of
from experiment_manager.preparation.continuation import check_settings
from experiment_manager.run.config_file import (
    CONFIG_FILE,
    Configuration,
    about_in,
    read_configuration,
)
from experiment_manager.sections import config_of
from experiment_manager.sweep import slurm
from experiment_manager.sweep.pool import Pool
from experiment_manager.sweep.status import table
from experiment_manager.sweep.sweep_file import SWEEP_FILE, Sweep, read_sweep
from experiment_manager.sweep.sweep_run import SweepRun
from eye_plant import EyePlantConfig, load_stimuli
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_INTERRUPTED
from lockstep.files.durable_files import is_free, replace_file
from lockstep.machine import start
from lockstep.written.command_line import command

# Command lines without their last arguments: of a run's process, and of a Slurm task.
_START_RUN = (sys.executable, "-m", start.__name__, f"{__package__}.sweep_run")
_START_SWEEP = (sys.executable, "-m", "active_binocular_vision.command_lines.sweep")
# Options that are sbatch's, by the name they have here.
_OF_SBATCH = {"partition": "partition", "time": "time", "memory": "mem"}


def _opened(options: argparse.Namespace) -> tuple[Path, Sweep]:
    """Return the directory of the sweep, which need not exist yet, and the sweep.

    Raises InputError for a directory that holds something else.
    """
    if options.sweep.is_dir():
        if options.out is not None or options.stimuli is not None:
            raise InputError(f"{options.sweep}: expected no --out and no --stimuli: it has its own")
        return options.sweep.resolve(), read_sweep(options.sweep / SWEEP_FILE)
    sweep = read_sweep(options.sweep, options.stimuli)
    directory = (options.out or Path("runs") / options.sweep.stem).resolve()
    held = directory / SWEEP_FILE
    if held.exists() and read_sweep(held) != sweep:
        raise InputError(
            f"{directory}: expected the directory of this sweep, it contains another; "
            f"{command('sweep')} {shlex.quote(str(directory))} continues that one"
        )
    if not held.exists() and not is_free(directory):
        raise InputError(f"{directory}: expected a new or empty directory, it is not empty")
    return directory, sweep


def _check(options: argparse.Namespace) -> None:
    for name in ("jobs", "tasks"):
        number = getattr(options, name)
        if number is not None and number < 1:
            raise InputError(f"--{name}: expected 1 or more, got {number}")
    given = [name for name in (*_OF_SBATCH, "tasks") if getattr(options, name)]
    if given and not options.slurm:
        raise InputError(f"--{given[0]}: expected it with --slurm only")
    if options.slurm and options.jobs is not None:
        raise InputError("--jobs: expected it without --slurm, which has --tasks")


def _check_begun(directory: Path, request: RunRequest) -> None:
    """Raise InputError where the sweep says something else than a run was begun with."""
    path = directory / CONFIG_FILE
    try:
        configuration = read_configuration(path)
        was_extended = "extended_from" in about_in(path.read_text())
    except (InputError, OSError):
        return  # it has not begun, or will say itself what is wrong
    if was_extended:
        request = replace(request, iterations=None, tests=None)
    check_settings(request, directory, configuration)


def _configuration(name: str, request: RunRequest, commit: str) -> Configuration:
    """Return the parameters of a run; raises InputError, naming it."""
    try:
        return configuration_of(request, commit)
    except InputError as error:
        raise InputError(f"{name}: {error}") from error


def _begin(directory: Path, sweep: Sweep) -> None:
    """Check all runs, and keep the sweep in its directory."""
    for name, request in sweep.runs().items():
        _check_begun(directory / name, request)
    text = sweep.text()  # refuses here what no file can have
    commit = source_commit()
    configurations = [_configuration(*run, commit) for run in sweep.runs().items()]
    print(f"{len(configurations)} runs in {directory}; preparing their stimuli")
    # Generated ones are made once, before the runs; pictures are seen to be readable.
    plants = [config_of(EyePlantConfig, configuration) for configuration in configurations]
    for stimuli in dict.fromkeys(plant.stimuli for plant in plants):
        load_stimuli(stimuli)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        replace_file(directory / SWEEP_FILE, text.encode())
    except OSError as error:
        raise InputError(f"{directory}: cannot be written: {error}") from error


def _run(options: argparse.Namespace) -> int:
    _check(options)
    directory, sweep = _opened(options)
    runs = [SweepRun(directory, name) for name in sweep.runs()]
    if options.task is not None:
        return slurm.run_task(runs[options.task], _START_RUN)
    if options.status:
        print(table(runs))
        return 0
    asked = {sbatch: getattr(options, name) for name, sbatch in _OF_SBATCH.items()}
    resources = [f"--{name}={value}" for name, value in asked.items() if value]
    if options.slurm:
        slurm.check(resources)
    _begin(directory, sweep)
    undone = [i for i, run in enumerate(runs) if not run.is_done]
    if options.slurm and undone:
        array = ",".join(map(str, undone)) + (f"%{options.tasks}" if options.tasks else "")
        task = (*_START_SWEEP, str(directory), "--task")
        job = slurm.submit(directory, array, task, resources)
        status = f"{command('sweep')} {shlex.quote(str(directory))} --status"
        print(f"job {job}: {len(undone)} tasks; {status}")
        return 0
    jobs = options.jobs or len(os.sched_getaffinity(0))
    code = Pool(jobs, _START_RUN).run([runs[i] for i in undone])
    print(table(runs))
    if code:
        line = f"{command('sweep')} {shlex.quote(str(directory))}"
        print(f"to continue: {line}", file=sys.stderr)
    return code


def main(argv: Sequence[str] | None = None) -> int:
    """Make the runs of a sweep; return the exit code."""
    try:
        return _run(parser().parse_args(argv))
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except KeyboardInterrupt:
        print("stopped before the first run", file=sys.stderr)
        return EXIT_INTERRUPTED
