"""Reads runs: from their newest checkpoint, or from what was once measured in it."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.landscape import RewardLandscape, reward_landscape
from active_binocular_vision.learners.basis_functions import Tuning, tuning
from active_binocular_vision.runs.reared_run import (
    MEASURES_FILE,
    RearedRun,
    ScaleTuning,
    read_measures,
)
from experiment_manager.experiment.plant_changes import Schedule, read_schedule
from experiment_manager.experiment.sections import config_of
from experiment_manager.measures.results import RESULTS_FILE, read_results
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, Configuration, read_configuration
from eye_plant import EyePlant, EyePlantConfig, StimulusSet, load_stimuli
from eye_plant.config import changed
from eye_plant.vergence import degrees_per_px
from lockstep import InputError, read_state
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.patches import PX_PER_PIXEL

_FOLDER = "rearing/"
_N_STIMULI = 10
_DISTANCES_M = (0.5, 2.0, 6.0)
# A quarter of a degree is about a pixel.
_ERRORS_DEG = np.arange(-16, 17) / 4.0

_N_SAMPLED = 12


def read_reared_run(directory: Path) -> RearedRun:
    """Measure a finished run, or read its measures from the sweep's rearing.json.

    Measuring takes 30 to 40 s: Gabor fits of all basis functions, and the pictures of the
    landscape. Without a checkpoint the measures are read. Raises InputError for a directory that
    has neither, or is no finished run.
    """
    configuration = read_configuration(directory / CONFIG_FILE)
    results = read_results(directory / RESULTS_FILE)
    if not results.tests:
        raise InputError(f"{directory}: expected a run with a complete test")
    schedule = read_schedule(configuration["task"]["schedule"])
    config = _plant_at_the_end(configuration, schedule)
    samples = None
    newest = checkpoint.newest(directory / "checkpoints")
    if newest is not None:
        landscape, scales, samples = _measured(newest[1], configuration, config)
    else:
        kept = read_measures(directory.parent / MEASURES_FILE, directory.name)
        if kept is None:
            raise InputError(
                f"{directory}: expected a checkpoint, or the run in ../{MEASURES_FILE}, found none"
            )
        landscape, scales = kept
    profile = configuration["experiment_manager"]["profile"]
    return RearedRun(
        directory=directory,
        condition=profile.removeprefix(_FOLDER) or directory.name,
        results=results,
        landscape=landscape,
        scales=scales,
        samples=samples,
        focal_length_px=config.camera.focal_length_px,
        changed_at=tuple(change.at for change in schedule.changes),
    )


def _measured(
    state: Path, configuration: Configuration, config: EyePlantConfig
) -> tuple[RewardLandscape, tuple[ScaleTuning, ...], NDArray[np.float32]]:
    """Return the landscape, the tuning of both scales, and samples of their basis functions."""
    coder = SparseCoder(config_of(SparseCoderConfig, configuration))
    coder.restore(read_state(state / "sparse_coder.npz", "sparse_coder"))
    atoms = coder.atoms()
    landscape = _landscape(config, coder)
    tunings = [
        tuning(of_scale.astype(np.float64), px)
        for of_scale, px in zip(atoms, PX_PER_PIXEL, strict=True)
    ]
    # From the best to the worst fit of a Gabor function.
    chosen = np.linspace(0, atoms.shape[1] - 1, _N_SAMPLED).astype(int)
    samples = [of[t.residual.argsort()[chosen]] for of, t in zip(atoms, tunings, strict=True)]
    scales = (
        scale_tuning(t, use, config.camera.focal_length_px)
        for t, use in zip(tunings, landscape.use, strict=True)
    )
    return landscape, tuple(scales), np.stack(samples)


def scale_tuning(tuned: Tuning, use: NDArray[np.float64], focal_length_px: float) -> ScaleTuning:
    """Return what is kept of the tuning of a scale's atoms; use: of each atom, (n_bases,).

    Disparities become angles at the picture's centre.
    """
    known_px = tuned.disparity_px[~np.isnan(tuned.disparity_px)]
    return ScaleTuning(
        gabor_share=float(tuned.is_gabor.mean()),
        gabor_share_by_use=float(use[tuned.is_gabor].sum()),
        common_gabor_share=float(tuned.is_common_gabor.mean()),
        binocular_share=tuned.binocular_share,
        orientation_counts=tuned.orientation_counts(),
        binocularity_counts=tuned.binocularity_counts(),
        preferred_disparities_deg=np.sort(known_px * degrees_per_px(focal_length_px)),
    )


def _plant_at_the_end(configuration: Configuration, schedule: Schedule) -> EyePlantConfig:
    plant = config_of(EyePlantConfig, configuration)
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
