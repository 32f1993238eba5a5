"""Settings of the experiment manager."""

from dataclasses import dataclass

from experiment_manager.plant_changes import check_places, read_schedule
from eye_plant import EyePlantConfig
from eye_plant.config import EyesConfig
from eye_plant.inverse.pair import Limits as PairLimits
from eye_plant.inverse.pair import pair_limits
from lockstep import InputError, setting
from lockstep.command_space import MUSCLES
from lockstep.task import MODELS, TaskConfig

# K17: 13 tests; the times are the authors' (public code), given here for 10^6 iterations.
PAPER_TEST_ITERATIONS = (
    *range(0, 200_001, 50_000),
    *range(300_000, 1_000_001, 100_000),
)

_LEAST_DISTANCE_M = 0.1
# Start errors of the pair's test trials: of the paper's text, and of its authors' code.
START_ERRORS = (OF_TEXT, OF_CODE) = ("text", "code")


@dataclass(frozen=True)
class ProtocolConfig(TaskConfig):
    """The task, what is shown, and when it is tested; defaults are the paper's.

    Raises InputError for values that make no experiment.
    """

    test_iterations: tuple[int, ...] = setting(
        PAPER_TEST_ITERATIONS,
        "training iterations before each test; tests beyond the end are left out, and one at the"
        " end is always made",
        least=0,
    )
    n_training_stimuli: int = setting(100, "training stimuli that the plant has", least=1)
    n_test_stimuli: int = setting(40, "test stimuli that the plant has", least=1)
    n_stimuli_per_test: int = setting(
        40, "number of test stimuli that a test shows, from the first", least=1
    )
    object_distance_m: tuple[float, ...] = setting(
        (0.5, 6.0),
        "distance of the plane in training, drawn uniformly",
        "m",
        least=_LEAST_DISTANCE_M,
        is_interval=True,
    )
    fixation_distance_m: tuple[float, ...] = setting(
        (0.5, 6.0),
        "initial fixation distance of a training episode, drawn uniformly",
        "m",
        least=_LEAST_DISTANCE_M,
        is_interval=True,
    )
    draws_vergence_evenly: bool = setting(
        False,
        "whether training draws the vergence angles of plane and eyes uniformly instead of their"
        " distances (D18)",
    )
    test_distances_m: tuple[float, ...] = setting(
        (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0),
        "distances of the plane in tests",
        "m",
        least=_LEAST_DISTANCE_M,
    )
    least_start_error_deg: int = setting(
        -3, "lowest vergence error at the start of a test trial", "deg", most=0
    )
    start_errors: str = setting(
        OF_TEXT,
        "vergence errors at the start of test trials: whole degrees from the lowest one to the"
        " largest without divergence, as in the paper's text, or those of the authors' code, from"
        " -2 deg to 2 deg at most",
        choices=START_ERRORS,
    )
    start_error_deg: tuple[float, ...] = setting(
        (3.0, 1.5, 4.0),
        "with a command for each muscle: largest horizontal, vertical and cyclovergence error at"
        " the start of an episode; those that commands can change are drawn uniformly",
        "deg",
        least=0,
        most=20,
        n_entries=3,
    )
    aside_share: float = setting(
        0.5,
        "with a command for each muscle: share of the episodes that begin with errors near the"
        " largest, on sides drawn once per run, and on the opposite ones in tests; so the mean of"
        " the starts does not tell the right posture",
        least=0,
        most=1,
    )
    tonic_start_spread: float = setting(
        0.0,
        "with a command for each muscle: standard deviation of the first activations of training"
        " episodes about the tonic level, drawn without an inverse of the eyes; 0: episodes begin"
        " with drawn errors",
        least=0,
        most=1,
    )
    tonic_common_spread: tuple[float, ...] = setting(
        (0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        "as tonic_start_spread, which it adds to: of what the muscles of a name have in common in"
        " both eyes, in the order of an eye's muscles",
        least=0,
        most=1,
        n_entries=len(MUSCLES),
    )
    tonic_return: float = setting(
        0.0,
        "with saccades: a training episode begins with the activations that the last one left, this"
        " share of the way back to the tonic level, so that nothing sets the eyes right in between;"
        " 1: each begins at rest, as all test trials do then; 0: all begin with drawn errors",
        least=0,
        most=1,
    )
    starts_follow_changes: bool = setting(
        False,
        "with a command for each muscle: whether training after a change of the eyes begins with"
        " errors of the changed eyes; otherwise with the activations that it began with before",
    )
    start_version_deg: tuple[float, ...] = setting(
        (5.0, 5.0),
        "with a command for each muscle: largest version and elevation at the start of an episode",
        "deg",
        least=0,
        most=20,
        n_entries=2,
    )
    start_spread: float = setting(
        0.03,
        "with a command for each muscle: standard deviation of initial activations about the tonic"
        " level, in the directions that do not change gaze",
        least=0,
        most=1,
    )
    n_starts_per_distance: int = setting(
        6, "with a command for each muscle: initial gazes at each distance of a test", least=1
    )
    gives_targets: bool = setting(
        True,
        "whether training gives a gaze target for each fixation, as tests do; otherwise the eyes"
        " choose the place whose code is worst",
    )
    target_distance_deg: tuple[float, ...] = setting(
        (2.0, 10.0),
        "distance of a gaze target from the one before, drawn uniformly",
        "deg",
        least=0,
        most=45,
        is_interval=True,
    )
    largest_target_deg: tuple[float, ...] = setting(
        (10.0, 10.0),
        "largest azimuth and elevation of gaze targets",
        "deg",
        above=0,
        most=45,
        n_entries=2,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range, and numbers that do not fit together."""
        super().__post_init__()
        if any(n % self.iterations_per_episode for n in self.test_iterations):
            raise InputError(
                f"test_iterations: expected multiples of {self.iterations_per_episode}, "
                f"got {list(self.test_iterations)}"
            )
        if self.tonic_return and not self.fixation_iterations:
            raise InputError(
                f"tonic_return: expected 0 without saccades (fixation_iterations 0), "
                f"got {self.tonic_return}"
            )
        if self.n_stimuli_per_test > self.n_test_stimuli:
            raise InputError(
                f"n_stimuli_per_test: expected {self.n_test_stimuli} or less, "
                f"got {self.n_stimuli_per_test}"
            )

    @property
    def pair_limits(self) -> PairLimits:
        """((lowest, highest) medial, (lowest, highest) lateral) first activations."""
        return pair_limits(self.turning_limits.lowest, self.turning_limits.highest)


@dataclass(frozen=True)
class ExperimentManagerConfig(ProtocolConfig, EyesConfig):
    """Settings of one run; raises InputError for a value out of range."""

    model: str = setting("M", "model, for the results", choices=MODELS)
    profile: str = setting("", "name of the run's profile, for the results; empty: none")
    run_directory: str = setting("", "directory of the run; empty: a new one under runs/")
    run_id: str = setting("", "name of the run in requests; empty: the name of its directory")
    commit: str = setting("", "commit of the source, for the results")
    checkpoint_period_s: float = setting(120.0, "wall time between checkpoints", "s", above=0)
    keeps_tested_checkpoints: bool = setting(
        False,
        "whether the checkpoint before each test is kept, for tests at another age; otherwise only"
        " the last two checkpoints are",
    )
    gap_s: float = setting(
        5.0, "wall time without a new message that counts as a fault", "s", above=0
    )
    pictures_every_n_episodes: int = setting(
        1000, "record images and features of every n-th training episode; 0: of none", least=0
    )
    pictures_every_n_trials: int = setting(
        230,
        "record images and features of every n-th test trial; 0: of none (a test has 39"
        " conditions per stimulus, so a multiple of 39 would record only one of them)",
        least=0,
    )
    resume: bool = setting(
        False, "whether to continue from the newest checkpoint of the run directory"
    )
    supervised: bool = setting(
        False,
        "whether a supervisor restarts all nodes after a fault; conditions that might pass by"
        " waiting then count as faults",
    )

    def __post_init__(self) -> None:
        """Refuse values out of range, and a schedule that the run or the eyes cannot keep."""
        super().__post_init__()
        schedule = read_schedule(self.schedule)
        check_places(schedule, self.n_training_iterations, self.iterations_per_episode)
        schedule.plants(self.plant)

    @property
    def plant(self) -> EyePlantConfig:
        """Of the plant's configuration what the first activations of episodes depend on."""
        return EyePlantConfig(mechanics=self.mechanics, camera=self.camera, lenses=self.lenses)
