"""A run that was made: what it is, and what it measured, each part read on first use."""

import json
from collections.abc import Callable, Mapping
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.runs.frames import (
    frame_of_basis_functions,
    frame_of_tests,
    frame_of_trials,
)
from active_binocular_vision.runs.recorded import Measured, measured
from experiment_manager import Bag, EvaluationSettings, Trials, summary_of
from experiment_manager.bag.metadata import CONFIGURATION_ATTACHMENT
from experiment_manager.measures.kept_trials import KeptTrials, read_kept
from experiment_manager.measures.results import (
    RESULTS_FILE,
    CostShares,
    Results,
    Summary,
    read_results,
    read_tests,
)
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import CONFIG_FILE, about_in, parameters_in
from experiment_manager.sections import Configuration
from experiment_manager.trained.directory import existing_run, run_directory
from lockstep import PAIR, InputError
from lockstep.scales import PATCH_SIZE_PX

if TYPE_CHECKING:
    import pandas

S = TypeVar("S")
T = TypeVar("T")
# What was found in a run's learners, at some or all of their ages.
EXAMINATIONS_FILE = "examinations.json"


class Run:
    """A run directory: config.yaml and results.json, trials.npz, checkpoints, a bag, or some.

    Each part raises InputError on its first use where it is damaged, or not there.

    Example:
        >>> import active_binocular_vision as abv
        >>> run = abv.Run("runs/first")
        >>> run.profile, run.model, run.seed
        ('precise', 'M', 1)
        >>> errors_deg = run.results["median_abs_vergence_error_deg"]  # a pandas.Series
        >>> errors_deg.index.tolist()  # training iterations before each test
        [0, 40]
        >>> sorted(set(run.trials["object_distance_m"]))  # a row per trial of each test
        [2.0]
        >>> coarse, fine = run.basis_functions()
        >>> coarse[0].shape  # left and right eye, 8 x 8 pixels
        (2, 8, 8)
        >>> run.bag.types["/ground_truth"]
        'sensor_msgs/msg/JointState'
    """

    def __init__(self, directory: str | Path) -> None:
        """directory: of the run, or the name of trained eyes."""
        self.directory = run_directory(directory)
        self.name = self.directory.resolve().name

    def unread(self) -> "Run":
        """Return the run without what was read of it: little to send to another process."""
        return Run(self.directory)

    # What the run is

    @cached_property
    def configuration_text(self) -> str:
        """config.yaml, or where that is missing what the bag has of it."""
        path = existing_run(self.directory) / CONFIG_FILE
        try:
            return path.read_text()
        except FileNotFoundError:
            if self.bag is not None:
                return self.bag.attachment(CONFIGURATION_ATTACHMENT).decode()
            raise InputError(f"{self.directory}: expected a run with {CONFIG_FILE}") from None
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"{path}: expected the configuration of a run: {error}") from error

    @cached_property
    def about(self) -> Mapping[str, Any]:
        """The section of config.yaml that says what the run is."""
        return self._named(about_in, self.configuration_text)

    @cached_property
    def configuration(self) -> Configuration:
        """All parameters by node, by dotted name, as in config.yaml."""
        return self._named(parameters_in, self.configuration_text)

    @cached_property
    def evaluation_settings(self) -> EvaluationSettings:
        """How the run is tested."""
        return self._named(EvaluationSettings.of, self.configuration)

    def _named(self, read: Callable[[S], T], source: S) -> T:
        """Return what a function reads; its errors name the run."""
        try:
            return read(source)
        except InputError as error:
            raise InputError(f"{self.directory}: {error}") from error

    @property
    def model(self) -> str:
        """M or M_C."""
        return str(self.about["model"])

    @property
    def profile(self) -> str:
        """Named settings that the run began with, "" for none."""
        return str(self.about.get("profile", ""))

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return int(self.about["seed"])

    @property
    def n_iterations(self) -> int:
        """Training iterations that the whole run has."""
        return int(self.about["n_training_iterations"])

    @property
    def metabolic_cost_weight(self) -> float:
        """Lambda, 1/W."""
        return float(self.about["metabolic_cost_weight"])

    @property
    def commit(self) -> str:
        """Commit of the source."""
        return str(self.about["commit"])

    @property
    def versions(self) -> tuple[str, ...]:
        """Libraries that the run was made with."""
        return tuple(str(version) for version in self.about.get("versions", ()))

    @property
    def is_of_pair(self) -> bool:
        """Whether two activations are commanded, the same in both eyes, as in K17."""
        return self.evaluation_settings.plant.turning_space == PAIR

    # What it measured

    @cached_property
    def document(self) -> Results:
        """What results.json says; of a run that has none, what follows from its bag."""
        path = existing_run(self.directory) / RESULTS_FILE
        if path.is_file():
            return read_results(path)
        if self.bag is None:
            raise InputError(
                f"{self.directory}: expected a run, with {RESULTS_FILE} or a bag; it has neither"
            )
        return self.results_of_bag()

    def results_of_bag(self) -> Results:
        """Return what results.json holds, from the bag alone."""
        criteria = self.evaluation_settings.criteria
        trials_of_tests = [test.trials for test in self.recorded.tests]
        return self.results_with(
            CostShares(*self.recorded.cost_shares),
            tuple(summary_of(t, criteria(t.training_iteration)) for t in trials_of_tests),
        )

    def results_with(self, cost_shares: CostShares, tests: tuple[Summary, ...]) -> Results:
        """Return results.json of this run with these measures."""
        return Results(
            model=self.model,
            profile=self.profile,
            seed=self.seed,
            iterations=self.n_iterations,
            commit=self.commit,
            metabolic_cost_weight=self.metabolic_cost_weight,
            cost_shares=cost_shares,
            tests=tests,
        )

    @cached_property
    def results(self) -> "pandas.DataFrame":
        """The measures of the tests, a row each, by training iteration."""
        return frame_of_tests(self.summaries)

    @cached_property
    def trials(self) -> "pandas.DataFrame":
        """Where each trial of the tests began and ended, a row each."""
        return frame_of_trials(self.tests)

    @property
    def summaries(self) -> tuple[Summary, ...]:
        """The measures of each test."""
        return self.document.tests

    @property
    def is_finished(self) -> bool:
        """Whether the test at the end of training has been made."""
        return any(test.iteration >= self.n_iterations for test in self.summaries)

    @cached_property
    def tests(self) -> dict[int, Trials]:
        """The trials of the tests by training iteration; none without trials.npz and bag."""
        tests = self.kept_trials.tests() if self.kept_trials is not None else []
        if not tests and self.bag is not None:
            tests = [test.trials for test in self.recorded.tests]
        return {test.training_iteration: test for test in tests}

    @cached_property
    def kept_trials(self) -> KeptTrials | None:
        """What trials.npz has, None without it."""
        return read_kept(self.directory)

    @cached_property
    def tests_of_learners(self) -> dict[str, tuple[Summary, ...]]:
        """The tests that abv examine made of the run's learners, by the names of its files."""
        files = sorted(self.directory.glob("*.json"))
        found = {path.stem: read_tests(path) for path in files if path.name != RESULTS_FILE}
        return {name: tests for name, tests in found.items() if tests}

    # What it left

    def learners(self, iteration: int | None = None) -> FrozenLearners:
        """Return the learners of the newest checkpoint, or of that after an iteration, frozen.

        Raises InputError where there is no such checkpoint.
        """
        if iteration is None:
            return FrozenLearners(self.directory)
        return FrozenLearners.after(self.directory, iteration)

    def basis_functions(self, iteration: int | None = None) -> NDArray[np.float32]:
        """Return them as pictures, (2 scales, n_bases, 2 eyes, 8, 8): coarse first, left first.

        iteration, errors: as of `learners`.
        """
        atoms = self.learners(iteration).atoms
        return atoms.reshape(*atoms.shape[:2], 2, PATCH_SIZE_PX, PATCH_SIZE_PX)

    def tuning(self, iteration: int | None = None) -> "pandas.DataFrame":
        """Return what each basis function is tuned to, a row each; fits Gabors for 10 s.

        iteration, errors: as of `learners`.
        """
        return frame_of_basis_functions(self.learners(iteration))

    @cached_property
    def bag(self) -> Bag | None:
        """The bag, None where there is none."""
        path = self.directory / "bag"
        return Bag(path) if path.is_dir() and any(path.iterdir()) else None

    @cached_property
    def recorded(self) -> Measured:
        """What the bag holds, reduced to what tables and figures need; InputError without a bag."""
        if self.bag is None:
            raise InputError(f"{self.directory}: expected a bag, found none")
        return measured(
            self.bag, self.evaluation_settings, self.n_iterations, self.metabolic_cost_weight
        )

    @cached_property
    def examinations(self) -> Mapping[str, Any]:
        """What was found in the run's learners: documents of examinations in "examined"."""
        path = self.directory / EXAMINATIONS_FILE
        try:
            return json.loads(path.read_bytes()) if path.is_file() else {"examined": []}
        except ValueError as error:
            raise InputError(f"{path}: expected JSON: {error}") from error

    @cached_property
    def states(self) -> Path | None:
        """Directory of the learners' states in the newest checkpoint, None without one."""
        newest = checkpoint.newest(self.directory / "checkpoints")
        return None if newest is None else newest[1]
