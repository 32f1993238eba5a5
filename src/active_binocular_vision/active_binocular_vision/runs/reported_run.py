"""A run as reports show it: from the small files that it leaves, and from its bag."""

from functools import cached_property
from pathlib import Path

from active_binocular_vision.runs.recorded_run import RecordedRun
from experiment_manager.measures.kept_trials import read_trials
from experiment_manager.measures.results import RESULTS_FILE, Summary, read_results
from experiment_manager.measures.trials import Trials
from experiment_manager.run.config_file import CONFIG_FILE
from experiment_manager.run.described_run import DescribedRun
from experiment_manager.sweep.sweep_file import SWEEP_FILE
from lockstep import PAIR, InputError

# The folder of a run or a report for pictures.
FIGURES = "figures"


class ReportedRun(DescribedRun):
    """A run directory: config.yaml and results.json, trials.npz, a bag, or some of these.

    recorded: the run as read from its bag, None without a bag.
    """

    def __init__(self, directory: Path) -> None:
        """Raise InputError for a directory that holds neither results nor a bag."""
        directory = Path(directory)
        bag = directory / "bag"
        self.recorded = RecordedRun(directory) if bag.is_dir() and any(bag.iterdir()) else None
        results = directory / RESULTS_FILE
        self._results = read_results(results) if results.is_file() else None
        if self.recorded is None and self._results is None:
            raise InputError(
                f"{directory}: expected a run, with {RESULTS_FILE} or a bag; it has neither"
            )
        if self.recorded is not None:
            text = self.recorded.configuration
        else:
            try:
                text = (directory / CONFIG_FILE).read_text()
            except (OSError, UnicodeDecodeError) as error:
                raise InputError(f"{directory}: expected its {CONFIG_FILE}: {error}") from error
        super().__init__(directory, text, str(directory))

    @property
    def is_of_pair(self) -> bool:
        """Whether two activations are commanded, the same in both eyes, as in K17."""
        return self.evaluation_settings.plant.command_space == PAIR

    @property
    def is_finished(self) -> bool:
        """Whether the test at the end of training has been made."""
        return any(test.iteration >= self.n_iterations for test in self.summaries)

    @cached_property
    def summaries(self) -> tuple[Summary, ...]:
        """The measures of each test."""
        if self._results is not None:
            return self._results.tests
        assert self.recorded is not None
        return self.recorded.summaries()

    @cached_property
    def trials(self) -> dict[int, Trials]:
        """The trials of the tests by training iteration; none without trials.npz and bag."""
        tests = read_trials(self.directory)
        if not tests and self.recorded is not None:
            tests = [test.trials for test in self.recorded.tests]
        return {test.training_iteration: test for test in tests}

    @property
    def cost_shares(self) -> tuple[float | None, float | None]:
        """Lambda's share of the reward over the first and last 5,000 training iterations."""
        if self._results is not None:
            return self._results.cost_share_first, self._results.cost_share_last
        assert self.recorded is not None
        return self.recorded.measured.cost_shares


def runs_below(directory: Path) -> list[Path]:
    """Return the run directories of a sweep, in the order of their names; else the directory."""
    if not (directory / SWEEP_FILE).is_file():
        return [directory]
    return sorted(path.parent for path in directory.rglob(CONFIG_FILE))
