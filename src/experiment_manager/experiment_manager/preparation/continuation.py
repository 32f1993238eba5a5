"""Going on with a run: as it is, for longer, or as another one that begins where it stood."""

import dataclasses
import shlex
import shutil
from pathlib import Path
from typing import Any

import msgspec

from experiment_manager.measures.trials import TrialTable
from experiment_manager.preparation.configuration import configuration_with, schedule_of
from experiment_manager.preparation.profiles import read_profile
from experiment_manager.preparation.request import ITERATIONS, TESTS, RunRequest
from experiment_manager.preparation.written_values import whole_number
from experiment_manager.protocol import Protocol, protocol_of
from experiment_manager.run import checkpoint
from experiment_manager.run.beginning import write_beginning
from experiment_manager.run.config_file import (
    CONFIG_FILE,
    check_unchanged,
    read_configuration,
    text_of_continuation,
)
from experiment_manager.run.progress import Progress
from experiment_manager.run.run_directory import ROWS, TRIALS_FILE, TRIALS_KIND
from experiment_manager.sections import (
    CONFIG_CLASSES,
    Configuration,
    by_key,
    by_section,
    completed,
    config_of,
)
from experiment_manager.trained.directory import existing_run, run_directory
from lockstep import InputError, read_state
from lockstep.files.durable_files import replace_file
from lockstep.written.paths import written_path
from sparse_coder import SparseCoder
from vergence_rl import Agent

# What a run decides for itself, whoever it begins from.
_OF_ONE_RUN = tuple(
    f"experiment_manager.{name}" for name in ("run_directory", "run_id", "resume", "supervised")
)
_LEARNERS = {"sparse_coder": SparseCoder, "vergence_rl": Agent}


def check_resumable(request: RunRequest, directory: Path) -> None:
    """Raise InputError unless a run can go on, and the request does not contradict it."""
    configuration = read_configuration(directory / CONFIG_FILE)
    check_settings(request, directory, configuration)
    newest = checkpoint.newest(directory / "checkpoints")
    if newest is not None:
        check_unchanged(directory, newest[0], configuration)


def check_settings(request: RunRequest, directory: Path, configuration: Configuration) -> None:
    """Raise InputError where a request contradicts the configuration of a run that is there.

    directory: of the run.
    """
    _check_whole_run(request, directory, configuration)
    asked = request.settings()
    values = {key: given.value for key, given in asked.items()}
    wanted = completed(by_section(by_key(configuration) | values))
    for key, given in asked.items():
        section, _, name = key.partition(".")
        found = configuration[section].get(name)
        if wanted[section][name] != found:
            raise contradiction(given.by, directory, f"{key} = {found}")


def _check_whole_run(request: RunRequest, directory: Path, configuration: Configuration) -> None:
    profile = configuration["experiment_manager"]["profile"]
    if request.profile is not None and request.profile != profile:
        raise contradiction(request.by("profile"), directory, f"profile {profile!r}")
    if request.schedule_delay is not None:
        schedule = configuration["task"]["schedule"]
        if schedule_of(read_profile(profile), request).text() != schedule:
            raise contradiction(request.by("schedule_delay"), directory, f"schedule {schedule}")


def contradiction(by: str, directory: Path, has: str) -> InputError:
    """Return the error that a run in a directory has another value than `by` asks for."""
    return InputError(
        f"{by}: the run to be resumed, {directory}, has {has}, and keeps it; "
        f"--branch {shlex.quote(str(directory))} begins a new run from its checkpoint"
    )


def extend(directory: Path, n_more: int) -> None:
    """Give a run n_more training iterations; its old end keeps its test.

    If it is killed, the same call completes it. Raises InputError when the run cannot be extended;
    then nothing has been changed.
    """
    if n_more < 1:
        raise InputError(f"--extend: expected 1 or more, got {n_more}")
    path = directory / CONFIG_FILE
    before = read_configuration(path)
    end = before["task"]["n_training_iterations"]
    tests = sorted({*before["experiment_manager"]["test_iterations"], end})
    after = by_section(by_key(before) | {ITERATIONS: end + n_more, TESTS: tests})
    protocol = protocol_of(after)
    space = protocol.config.space
    manifests = []
    for manifest, states in checkpoint.everyone(directory / "checkpoints"):
        if manifest.parameters == after:
            # By an extension that was killed before it came to config.yaml.
            continue
        check_unchanged(directory, manifest, before)
        progress = Progress(end, space)
        rows = read_state(states / TRIALS_FILE, TRIALS_KIND)[ROWS]
        progress.restore(manifest.progress, TrialTable.saved(rows, space))
        progress.extend(end + n_more, protocol.training_iterations_before(manifest.place))
        manifests.append(
            msgspec.structs.replace(manifest, parameters=after, progress=progress.state())
        )
    text = text_of_continuation(path.read_text(), after, {"extended_from": end})
    for manifest in manifests:
        checkpoint.write(directory / "checkpoints", manifest)
    replace_file(path, text.encode())


@dataclasses.dataclass(frozen=True)
class Branch:
    """A new run that is to begin where another one stood.

    training_iterations: done at the checkpoint; source: the other run's directory.
    """

    source: Path
    training_iterations: int
    configuration: Configuration
    states: Path

    def write(self, directory: Path) -> None:
        """Make the new run's directory one that can be resumed: its configuration, a checkpoint.

        Raises OSError when the disk refuses.
        """
        about = {
            "branched_from": str(self.source),
            "branched_at_iteration": self.training_iterations,
        }
        text = text_of_continuation("", self.configuration, about)
        write_beginning(
            directory, self.configuration, text, self.training_iterations, self._copy_states
        )

    def _copy_states(self, to: Path) -> None:
        for name in _LEARNERS:
            shutil.copyfile(self.states / f"{name}.npz", to / f"{name}.npz")


def branch(text: str, request: RunRequest, commit: str) -> Branch:
    """Return the run that begins from RUN[@ITERATION], with the single settings of a request.

    Raises InputError for a run, checkpoint or setting that cannot be used.
    """
    for name in ("profile", "schedule_delay"):
        if getattr(request, name) is not None:
            raise InputError(
                f"--branch: expected the settings of {text} and single ones, got {request.by(name)}"
            )
    source, iteration = _source(text)
    before = read_configuration(source / CONFIG_FILE)
    trained, states = _chosen(source, protocol_of(before), iteration)
    _check_command_space(source, before, request)
    settings = {key: value for key, value in by_key(before).items() if key not in _OF_ONE_RUN}
    settings["experiment_manager.commit"] = commit
    configuration = configuration_with(settings, request)
    protocol = protocol_of(configuration)
    _check_end(protocol.config.n_training_iterations, trained, request)
    protocol.place_after(trained)
    for node, learner in _LEARNERS.items():
        # The nodes would refuse what does not fit; here it costs nothing.
        config: Any = config_of(CONFIG_CLASSES[node], configuration)
        learner(config).restore(read_state(states / f"{node}.npz", node))
    return Branch(source, trained, configuration, states)


def _source(text: str) -> tuple[Path, int | None]:
    """Return the run, and the iteration or None, that RUN[@ITERATION] names.

    Raises InputError where it may be a run of that very name, or the iteration of another.
    """
    whole = written_path(text).resolve()
    name, at, word = text.rpartition("@")
    try:
        iteration = whole_number(word) if at else None
    except InputError:
        iteration = None
    if iteration is None:
        return existing_run(whole if whole.exists() else text).resolve(), None
    source = run_directory(written_path(name)).resolve()
    if not (whole / CONFIG_FILE).exists():
        return source, iteration
    if not (source / CONFIG_FILE).exists():
        return whole, None
    raise InputError(
        f"--branch {text}: expected one run, {whole} is one, and so is {source}: write {text}/ for "
        f"the first, {name}/@{word} for the second"
    )


def _check_command_space(source: Path, before: Configuration, request: RunRequest) -> None:
    """Raise InputError for a branch whose learners have commanded other muscles."""
    space = before["task"]["command_space"]
    for key, given in request.settings().items():
        if key.endswith("command_space") and given.value != space:
            raise InputError(
                f"{given.by}: expected {space}, with which the learners of {source} were trained"
            )


def _check_end(end: int, trained: int, request: RunRequest) -> None:
    """Raise InputError for an end of training that lies before a branch's checkpoint."""
    if end < trained:
        by = request.by("iterations") if request.iterations is not None else "n_training_iterations"
        raise InputError(
            f"{by}: expected {trained} or more, since a branch counts on from its checkpoint, "
            f"which has made {trained}; {trained + end} would train for {end} more"
        )


def _chosen(source: Path, protocol: Protocol, iteration: int | None) -> tuple[int, Path]:
    """Return training iterations and states of the newest checkpoint, or of that at an iteration.

    The newest one, where several have made as many: during a test, learners stand still.
    """
    found = {
        protocol.training_iterations_before(manifest.place): states
        for manifest, states in checkpoint.everyone(source / "checkpoints")
    }
    trained = max(found, default=0) if iteration is None else iteration
    if trained not in found:
        raise InputError(
            f"{source}: expected a checkpoint to begin from"
            + ("" if iteration is None else f" after {iteration} training iterations")
            + f", there is one after {', '.join(map(str, sorted(found))) or 'none'}"
        )
    return trained, found[trained]
