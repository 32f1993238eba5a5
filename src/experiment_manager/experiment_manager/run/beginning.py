"""A run directory whose run has begun: with learners that were trained before it."""

from collections.abc import Callable
from pathlib import Path

from experiment_manager.protocol import protocol_of
from experiment_manager.run import checkpoint
from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.run.progress import Progress
from experiment_manager.run.run_directory import ROWS, TRIALS_FILE, TRIALS_KIND
from experiment_manager.sections import Configuration
from lockstep import write_state
from lockstep.files.durable_files import replace_file


def write_beginning(
    directory: Path,
    configuration: Configuration,
    text: str,
    training_iterations: int,
    write_states: Callable[[Path], None],
) -> None:
    """Write config.yaml and a checkpoint after so many training iterations.

    text: of config.yaml; write_states: writes the learners' states into a directory.
    Raises OSError when the disk refuses.
    """
    protocol = protocol_of(configuration)
    place = protocol.place_after(training_iterations)
    checkpoints = directory / "checkpoints"
    to = checkpoint.place_directory(checkpoints, place)
    to.mkdir(parents=True)
    progress = Progress(protocol.config.n_training_iterations, protocol.config.space)
    progress.begin_at(training_iterations)
    write_state(to / TRIALS_FILE, TRIALS_KIND, {ROWS: progress.trial_table().rows})
    write_states(to)
    replace_file(directory / CONFIG_FILE, text.encode())
    files = sorted(to.iterdir())
    hashes = {path.name: checkpoint.hash_of(path) for path in files}
    checkpoint.commit(checkpoints, Manifest(place, configuration, (), hashes, progress.state()))
