"""Prepares a run, has it supervised to its end, and shows what came out."""

import argparse
import json
import os
import shlex
import subprocess
import sys
from collections.abc import Callable, Collection, Sequence
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

from active_binocular_vision.commands.command_line import arguments, request_of
from experiment_manager import EvaluationSettings, RunRequest, configuration_of, protocol_of
from experiment_manager.live.address import Address
from experiment_manager.live.server import why_unavailable
from experiment_manager.measures.results import RESULTS_FILE, Results, read_results
from experiment_manager.measures.tables import in_words, summaries_table
from experiment_manager.preparation.continuation import (
    Branch,
    branch,
    check_resumable,
    check_settings,
    contradiction,
    extend,
)
from experiment_manager.run.config_file import (
    CONFIG_FILE,
    Configuration,
    configuration_text,
    read_configuration,
)
from experiment_manager.run.hold import hold
from experiment_manager.run.in_process import run_in_process
from experiment_manager.run.run_directory import new_directory
from experiment_manager.sections import config_of
from experiment_manager.supervision.node_neighbours import check_ros
from experiment_manager.supervision.supervisor import Supervisor, known_domain
from eye_plant import EyePlantConfig, load_stimuli
from eye_plant.stimuli.stimulus_set import announcement
from lockstep import COMMAND_SPACES, InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_DIVERGED, EXIT_FAULT, EXIT_INTERRUPTED
from lockstep.files.durable_files import (
    first_to_make,
    is_free,
    replace_file,
    why_unwritable,
)
from lockstep.machine.environment import reaches_other_machines
from lockstep.written.command_line import command
from lockstep.written.yaml_text import yaml_line

PLANT = "eye_plant"
# After a fault of learning there is nothing to continue: it would come again.
_TO_CONTINUE = {
    EXIT_INTERRUPTED: "to continue",
    EXIT_FAULT: "once the cause is gone, to continue",
}
# How a node is started that is awaited on another machine.
_NODE_COMMANDS = {"eye_plant": "plant", "sparse_coder": "coder", "vergence_rl": "agent"}


def source_commit() -> str:
    """Return the commit of the source, "unknown" when it is not in git."""
    here = Path(__file__)
    # This file in it, too: around a copy of the source there may be somebody else's repository.
    command = ["git", "-C", str(here.parent), "rev-parse", f"HEAD:./{here.name}", "HEAD"]
    kept = {n: v for n, v in os.environ.items() if not n.startswith("GIT_") or "CONFIG" in n}
    try:
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=kept)
    except (OSError, subprocess.CalledProcessError):
        return _installed_commit()
    return done.stdout.split()[-1]


def _installed_commit() -> str:
    """Return the commit that pip installed from a repository, else "unknown"."""
    try:
        origin = distribution("active-binocular-vision").read_text("direct_url.json")
        return str(json.loads(origin or "{}")["vcs_info"]["commit_id"])
    except (PackageNotFoundError, KeyError, ValueError):
        return "unknown"


def _prepare_stimuli(configuration: Configuration) -> None:
    """Make the generated stimuli now if they are not in the cache: a node has no time for that."""
    plant = config_of(EyePlantConfig, configuration)
    stimuli = plant.stimuli
    if plant.space.of_joints:
        return  # a head sees the world, or its own
    if stimuli.directory:
        print(f"reading the images of {stimuli.directory}")
    elif text := announcement(stimuli):
        print(text)
    load_stimuli(stimuli)


def _say_how_to_start(nodes: Collection[str], domain: int | None, config: Path) -> None:
    """Tell a person what to do on another machine."""
    reach = "SUBNET" if reaches_other_machines(os.environ) else "LOCALHOST"
    task = read_configuration(config)["task"]
    for node in nodes:
        if node == PLANT and COMMAND_SPACES[task["command_space"]].of_joints:
            print(
                f"a head is awaited; where it is:\n  ROS_DOMAIN_ID={domain} "
                f"ROS_AUTOMATIC_DISCOVERY_RANGE={reach} {sys.executable} YOUR_HEAD.py"
            )
            continue
        print(
            f"{node} is awaited; on its machine, with a copy of {config}:\n"
            f"  ROS_DOMAIN_ID={domain} ROS_AUTOMATIC_DISCOVERY_RANGE={reach} "
            f"{command(_NODE_COMMANDS[node])} --ros-args --params-file {config.name}"
        )


def _check_in_process(options: argparse.Namespace) -> None:
    for name in ("elsewhere", "live"):
        if options.in_process and getattr(options, name):
            raise InputError(f"--in-process: expected it without --{name}, got both")


def _live(options: argparse.Namespace) -> Address | None:
    """Return where a live view is to listen, having said so, or None when there is to be none.

    Raises InputError where it cannot.
    """
    if options.live is None:
        return None
    address: Address = options.live
    address.check()
    page = Address(address.host, address.port + 1)
    viewers = f"ws://{address} for Lichtblick or Foxglove"
    print(f"live view: http://{page} in a browser; {why_unavailable() or viewers}")
    return address


def prepare(options: argparse.Namespace) -> Path:
    """Return the run directory that the command line asks for, with its config.yaml."""
    request = request_of(options)
    directory = (options.resume or options.out or new_directory()).resolve()
    if not options.in_process:
        yaml_line(str(directory))  # refuses what no node could be told
    if options.resume is not None:
        return _prepare_old(options, request, directory)
    if options.extend is not None:
        raise InputError("--extend: expected it with --resume, got it alone")
    branched = None
    if options.branch is not None:
        branched = branch(options.branch, request, source_commit())
    return prepare_new(request, directory, branched, has_head=PLANT in options.elsewhere)


def prepare_new(
    request: RunRequest,
    directory: Path,
    branched: Branch | None = None,
    *,
    has_head: bool = False,
) -> Path:
    """Make the directory of a new run, with its config.yaml; return it.

    branched: what the run begins from; has_head: whether something else than our eyes may be the
    plant. Raises InputError for a request that no run can meet, and a directory that holds
    something.
    """
    if not is_free(directory):
        raise _used(directory)
    configuration = (
        configuration_of(request, source_commit()) if branched is None else branched.configuration
    )
    text = configuration_text(configuration)
    space = configuration["task"]["command_space"]
    if COMMAND_SPACES[space].of_joints and not has_head:
        raise InputError(
            f"command_space {space}: expected a head, with --elsewhere eye_plant or "
            "abv.run(head=...) (docs/how_to/own_head.md); our eyes have muscles"
        )
    _prepare_stimuli(configuration)
    try:
        directory.mkdir(parents=True, exist_ok=True)
        with first_to_make(directory / CONFIG_FILE):  # another run may have begun there since
            if branched is not None:
                branched.write(directory)
            else:
                replace_file(directory / CONFIG_FILE, text.encode())
    except FileExistsError as error:
        raise _used(directory) from error
    except OSError as error:
        raise InputError(f"{directory}: cannot be written: {error}") from error
    return directory


def _prepare_old(options: argparse.Namespace, request: RunRequest, directory: Path) -> Path:
    if options.branch is not None:
        raise InputError("--branch: expected it without --resume, got both")
    if options.out is not None and options.out.resolve() != directory:
        raise contradiction(f"--out {options.out}", directory, "a directory of its own")
    if options.extend is None:
        check_old(directory, request)
    else:
        # Its checkpoints may already be longer: an extension that was killed writes them first.
        check_settings(request, directory, read_configuration(directory / CONFIG_FILE))
        _check_writable(directory)
        extend(directory, options.extend)
    return directory


def check_old(directory: Path, request: RunRequest) -> None:
    """Raise InputError unless the run in a directory can go on, as the request asks."""
    check_resumable(request, directory)
    _check_writable(directory)


def _check_writable(directory: Path) -> None:
    if why := why_unwritable(directory):
        raise InputError(f"{directory}: cannot be written: {why}")
    hold(directory).close()


def _used(directory: Path) -> InputError:
    return InputError(
        f"{directory}: expected a new or empty directory, it is not empty; "
        f"--resume {shlex.quote(str(directory))} continues a run"
    )


def figure_of(directory: Path) -> Path | None:
    """Draw the learning curve; None, with the reason on standard error, when it cannot be drawn."""
    # Matplotlib takes a second to import, for which the start of a run need not wait.
    from active_binocular_vision.figures.runs.learning_curve import learning_curve  # noqa: PLC0415

    try:
        return learning_curve(directory)
    except Exception as error:  # no figure is worth the table and the exit code of a run
        print(f"no learning curve: {error}", file=sys.stderr)
        return None


def results_table(results: Results, directory: Path, figure: Path | None) -> str:
    """Return the tests of a results.json as text, and where everything lies."""
    last = results.tests[-1]
    settings = EvaluationSettings.of(read_configuration(directory / CONFIG_FILE))
    words = in_words(last, settings.criteria(last.iteration).px_deg)
    return (
        f"\nmodel {results.model}, seed {results.seed}: "
        "tests by training iteration, at the end of each trial\n\n"
        f"{summaries_table(results.tests)}\n\n"
        f"{words}\n\n"
        f"results: {directory / RESULTS_FILE}\n"
        f"figure:  {figure or 'none'}\n"
        f"bag:     {directory / 'bag'}"
    )


def _run(options: argparse.Namespace) -> tuple[Path, int]:
    """Prepare the run and bring it to its end; return its directory and the exit code."""
    _check_in_process(options)
    if options.in_process:
        return in_one_process(prepare(options))
    domain = known_domain(options.elsewhere)
    check_ros(domain, options.elsewhere)
    live = _live(options)
    directory = _announced(prepare(options))
    _say_how_to_start(options.elsewhere, domain, directory / CONFIG_FILE)
    return directory, Supervisor(directory, options.elsewhere, live).run()


def in_one_process(directory: Path) -> tuple[Path, int]:
    """Bring a prepared run to its end in this process; return its directory and the exit code."""
    return directory, run_in_process(_announced(directory))


def _announced(directory: Path) -> Path:
    protocol = protocol_of(read_configuration(directory / CONFIG_FILE))
    print(
        f"run directory: {directory}\n"
        f"{protocol.config.n_training_iterations:,} training iterations, "
        f"tests after {', '.join(f'{n:,}' for n in protocol.test_iterations)}: "
        f"{protocol.n_trials:,} trials of {protocol.config.iterations_per_trial} iterations each"
        " (fewer: --test-stimuli)"
    )
    return directory


def concluded(run: Callable[[], tuple[Path, int]], more: str) -> int:
    """Make a run, and show what came out or why nothing did; return the exit code.

    run: returns the directory and its exit code, raises InputError; more: what a command line that
    goes on with it has besides --resume.
    """
    try:
        directory, code = run()
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    except KeyboardInterrupt:
        print("stopped before the run began", file=sys.stderr)
        return EXIT_INTERRUPTED
    if code == 0:
        print(
            results_table(read_results(directory / RESULTS_FILE), directory, figure_of(directory))
        )
    elif code in _TO_CONTINUE:
        line = f"{command('run')} --resume {shlex.quote(str(directory))}{more}"
        print(f"{_TO_CONTINUE[code]}: {line}", file=sys.stderr)
    return EXIT_FAULT if code == EXIT_DIVERGED else code


def main(argv: Sequence[str] | None = None) -> int:
    """Run one experiment; return the exit code."""
    options = arguments(argv)
    more = f" --elsewhere {','.join(options.elsewhere)}" if options.elsewhere else ""
    return concluded(lambda: _run(options), more + (" --in-process" if options.in_process else ""))
