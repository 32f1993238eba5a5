"""What a run has become: its results, and what its newest checkpoint has learned."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from experiment_manager.analysis.basis_functions import Tuning, tuning
from experiment_manager.analysis.rearing.reward_landscape import RewardLandscape, reward_landscape
from experiment_manager.experiment.plant_changes import Schedule, read_schedule
from experiment_manager.measures.results import RESULTS_FILE, Results, read_results
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, Configuration, read_configuration
from eye_plant.config import EyePlantConfig, changed
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimulusSet, load_stimuli
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.state_file import read_state
from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.patches import PX_PER_PIXEL

_FOLDER = "rearing/"
_N_STIMULI = 10
_DISTANCES_M = (0.5, 2.0, 6.0)
# A quarter of a degree is about a pixel.
_ERRORS_DEG = np.arange(-16, 17) / 4.0


@dataclass(frozen=True)
class RearedRun:
    """One run of a condition.

    condition: its profile without the folder, or the directory's name; atoms: both dictionaries,
    (2, n_bases, 128); tunings: coarse, fine; focal_length_px: of the cameras; changed_at: training
    iterations at which its schedule changes the plant.
    """

    directory: Path
    condition: str
    results: Results
    atoms: NDArray[np.float32]
    tunings: tuple[Tuning, ...]
    landscape: RewardLandscape
    focal_length_px: float
    changed_at: tuple[int, ...]


def read_reared_run(directory: Path) -> RearedRun:
    """Measure a finished run; raises InputError for a directory that holds none.

    Takes 30 to 40 s: Gabor fits of all basis functions, and the pictures of the landscape.
    """
    configuration = read_configuration(directory / CONFIG_FILE)
    results = read_results(directory / RESULTS_FILE)
    if not results.tests:
        raise InputError(f"{directory}: expected a run with a complete test")
    newest = checkpoint.newest(directory / "checkpoints")
    if newest is None:
        raise InputError(f"{directory}: expected a checkpoint, found none")
    coder = SparseCoder(build(SparseCoderConfig, configuration["sparse_coder"]))
    coder.restore(read_state(newest[1] / "sparse_coder.npz", "sparse_coder"))
    atoms = coder.atoms()
    schedule = read_schedule(configuration["experiment_manager"]["schedule"])
    plant = _plant_at_the_end(configuration, schedule)
    profile = configuration["experiment_manager"]["profile"]
    return RearedRun(
        directory=directory,
        condition=profile.removeprefix(_FOLDER) or directory.name,
        results=results,
        atoms=atoms,
        tunings=tuple(
            tuning(of_scale.astype(np.float64), px)
            for of_scale, px in zip(atoms, PX_PER_PIXEL, strict=True)
        ),
        landscape=_landscape(plant, coder),
        focal_length_px=plant.camera.focal_length_px,
        changed_at=tuple(change.at for change in schedule.changes),
    )


def _plant_at_the_end(configuration: Configuration, schedule: Schedule) -> EyePlantConfig:
    plant = build(EyePlantConfig, configuration["eye_plant"])
    return changed(plant, schedule.settings(len(schedule.changes)))


def _landscape(config: EyePlantConfig, coder: SparseCoder) -> RewardLandscape:
    pictures = load_stimuli(config.stimuli).test[:_N_STIMULI]
    plant = EyePlant(config, StimulusSet((), pictures))
    try:
        return reward_landscape(
            plant,
            config.mechanics,
            coder,
            stimuli=range(len(pictures)),
            distances_m=_DISTANCES_M,
            vergence_errors_deg=_ERRORS_DEG.tolist(),
        )
    finally:
        plant.close()
