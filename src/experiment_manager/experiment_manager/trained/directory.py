"""Trained eyes as run directories, unpacked into this user's cache when they are asked for."""

import hashlib
import os
import tempfile
from pathlib import Path

from experiment_manager.measures.results import RESULTS_FILE
from experiment_manager.protocol import protocol_of
from experiment_manager.run import checkpoint
from experiment_manager.run.beginning import write_beginning
from experiment_manager.run.config_file import CONFIG_FILE, parameters_in, read_configuration
from experiment_manager.sections import completed
from experiment_manager.trained.eyes_file import name_of_file, packed, unpacked
from lockstep import InputError, read_state, write_state
from lockstep.files.durable_files import replace_file
from lockstep.files.user_cache import user_cache
from lockstep.written.nearest import did_you_mean

FOLDER = Path(__file__).with_name("eyes")
_LEARNERS = ("sparse_coder", "vergence_rl")


def trained_eyes() -> dict[str, Path]:
    """Return the files of trained eyes that come with the package, by name."""
    files = sorted(FOLDER.glob("*.eyes"))
    return {file.stem.replace(".", "/"): file for file in files}


def file_of(name: str) -> Path:
    """Return the file of trained eyes of a name, which need not be there; InputError for none."""
    return FOLDER / name_of_file(name)


def run_directory(run: str | os.PathLike[str]) -> Path:
    """Return the directory of a run: the one named, a file of trained eyes' or trained eyes'.

    A path that exists takes precedence over a name. Raises InputError for a damaged file and where
    it cannot be unpacked.
    """
    path = Path(run)
    if path.is_file():
        return _directory(path, path.stem)
    file = trained_eyes().get(str(run))
    return path if file is None or path.exists() else _directory(file, Path(run).name)


def existing_run(run: str | os.PathLike[str]) -> Path:
    """Return run_directory of a run that is there; raises InputError for another, too."""
    directory = run_directory(run)
    if not directory.exists():
        raise InputError(
            f"expected a run directory or trained eyes, got {run}"
            f"{did_you_mean(str(run), trained_eyes())}"
        )
    return directory


def pack(run: Path, file: Path) -> int:
    """Write the learners of a finished run's last checkpoint into a file; return its bytes.

    Raises InputError for a run that has not ended, and OSError when the disk refuses.
    """
    configuration = read_configuration(run / CONFIG_FILE)
    protocol = protocol_of(configuration)
    newest = checkpoint.newest(run / "checkpoints")
    results = run / RESULTS_FILE
    if newest is None or newest[0].place < len(protocol) or not results.is_file():
        raise InputError(f"{run}: expected a run that has ended, with its checkpoint")
    states = {name: read_state(newest[1] / f"{name}.npz", name) for name in _LEARNERS}
    text = (run / CONFIG_FILE).read_text()
    data = packed(text, results.read_bytes(), protocol.config.n_training_iterations, states)
    file.parent.mkdir(parents=True, exist_ok=True)
    replace_file(file, data)
    return len(data)


def _directory(file: Path, name: str) -> Path:
    """Return the directory of a file, unpacked unless it is there already."""
    data = file.read_bytes()
    directory = user_cache() / "trained" / hashlib.sha256(data).hexdigest()[:12] / name
    if (directory / CONFIG_FILE).exists():
        return directory
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=directory.parent) as folder:
            part = Path(folder) / name
            _unpack(data, part)
            if not directory.exists():  # another process may have been faster
                part.rename(directory)
    except OSError as error:
        raise InputError(
            f"{file}: expected a directory to unpack it into, got {directory} ({error}); "
            "XDG_CACHE_HOME=DIR names another one"
        ) from error
    except InputError as error:
        raise InputError(f"{file}: {error}") from error
    return directory


def _unpack(data: bytes, directory: Path) -> None:
    eyes, states = unpacked(data)

    def write_states(to: Path) -> None:
        for name, state in states.items():
            write_state(to / f"{name}.npz", name, state)

    configuration = completed(parameters_in(eyes.configuration))
    write_beginning(directory, configuration, eyes.configuration, eyes.iteration, write_states)
    replace_file(directory / RESULTS_FILE, eyes.results)
