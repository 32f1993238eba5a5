"""Examines a run's learners at each age, or reads what was once found."""

import math
from pathlib import Path

import numpy as np

from active_binocular_vision.examinations import acuity, cover
from active_binocular_vision.examinations.room import examination_room
from active_binocular_vision.learners.basis_functions import tuning
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from active_binocular_vision.runs.examined_run import ExaminedAge, ExaminedRun, ages_of
from experiment_manager.experiment.plant_changes import read_schedule
from experiment_manager.experiment.protocol import protocol_of
from experiment_manager.experiment.sections import config_of
from experiment_manager.measures.kept_trials import read_trials
from experiment_manager.measures.results import RESULTS_FILE, Results, read_results
from experiment_manager.run.config_file import CONFIG_FILE, Configuration, read_configuration
from lockstep import InputError
from sparse_coder import SparseCoderConfig
from sparse_coder.patches import PX_PER_PIXEL

_FOLDER = "clinic/"
_DISTANCE_M = 2.0


def examined_run(directory: Path) -> ExaminedRun:
    """Examine the learners of a finished run at each age, and write that into its directory.

    It takes about 15 s for each age, and needs the checkpoints before the tests. What a
    file there already has of the same ages is read instead. Raises InputError for a run that is not
    finished, lacks a checkpoint, or cannot be examined; OSError when the disk refuses.
    """
    results = read_results(directory / RESULTS_FILE)
    configuration = read_configuration(directory / CONFIG_FILE)
    n_iterations = configuration["task"]["n_training_iterations"]
    tested = [test.iteration for test in results.tests]
    if not tested or tested[-1] != n_iterations:
        raise InputError(f"{directory}: expected a run with a test at its end, {n_iterations:,}")
    changes = read_schedule(configuration["task"]["schedule"]).changes
    changed_at = changes[0].at if changes else None
    ages = ages_of(tested, changed_at)
    kept = ExaminedRun.read(directory)
    if kept is not None and {age.when: age.iteration for age in kept.ages} == ages:
        return kept
    coder = config_of(SparseCoderConfig, configuration)
    run = ExaminedRun(
        condition=results.profile.removeprefix(_FOLDER) or directory.name,
        model=results.model,
        seed=results.seed,
        iterations=results.iterations,
        changed_at=changed_at,
        final_learning_rate=coder.learning_rate * coder.final_learning_rate_share,
        ages=tuple(
            _examined(directory, configuration, results, when, iteration)
            for when, iteration in ages.items()
        ),
    )
    run.write(directory)
    return run


def _examined(
    directory: Path, configuration: Configuration, results: Results, when: str, iteration: int
) -> ExaminedAge:
    learners = FrozenLearners(directory, protocol_of(configuration).place_after(iteration))
    covers = cover.examine(learners, distances_m=(_DISTANCE_M,), at_rest=True).to_json()
    left, right = covers["conditions"]
    deviation_pd = right["phoria_prism_dioptres"]
    sight = acuity.examine(learners)
    coarse, fine = _binocular_shares(learners)
    test = next(test for test in results.tests if test.iteration == iteration)
    return ExaminedAge(
        when=when,
        iteration=iteration,
        horizontal_deviation_pd=deviation_pd["horizontal"]["median"],
        vertical_deviation_pd=deviation_pd["vertical"]["median"],
        share_fused=(left["share_fused"] + right["share_fused"]) / 2.0,
        left_acuity_cycles_per_deg=sight.resolutions[0].acuity,
        right_acuity_cycles_per_deg=sight.resolutions[1].acuity,
        stereo_threshold_arcsec=sight.to_json()["stereo"]["threshold_arcsec"],
        left_share_in_code=_known(sight.left_share),
        binocular_share_coarse=coarse,
        binocular_share_fine=fine,
        metabolic_rate_w=_metabolic_rate_w(directory, iteration),
        share_within_1_px=test.share_within_1_px,
    )


def _binocular_shares(learners: FrozenLearners) -> list[float | None]:
    with examination_room(learners, Shown(n_most=1), 1) as room:
        atoms = room.loop.coder.atoms().astype(np.float64)
    scales = zip(atoms, PX_PER_PIXEL, strict=True)
    return [_known(tuning(of_scale, px).binocular_share) for of_scale, px in scales]


def _metabolic_rate_w(directory: Path, iteration: int) -> float | None:
    """Return the median C after the last iteration of the trials of a test."""
    tests = {test.training_iteration: test for test in read_trials(directory)}
    if iteration not in tests:
        return None
    return _known(float(np.median(tests[iteration].metabolic_rate_w[:, -1])))


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None
