"""Settings of the experiment manager."""

import dataclasses
from dataclasses import dataclass, field

from experiment_manager.experiment.plant_changes import check_places, read_schedule
from eye_plant.camera.config import CameraConfig, CameraTurns
from eye_plant.config import EyePlantConfig
from eye_plant.inverse.pair import Limits as PairLimits
from eye_plant.inverse.pair import pair_limits
from eye_plant.mechanics.model import MechanicsConfig
from lockstep.command_space import (
    ALL_MUSCLES,
    COMMAND_SPACES,
    HIGHEST_ACTIVATIONS,
    LOWEST_ACTIVATIONS,
    PAIR,
    CommandSpace,
    Limits,
    activation_limits,
)
from lockstep.errors import InputError
from lockstep.settings import check_settings, setting

MODELS = ("M", "M_C")

# K17: 13 tests; the times are the authors' (public code), given here for 10^6 iterations.
PAPER_TEST_ITERATIONS = (
    *range(0, 200_001, 50_000),
    *range(300_000, 1_000_001, 100_000),
)

_LEAST_DISTANCE_M = 0.1


@dataclass(frozen=True)
class ProtocolConfig:
    """What is shown, how long, and when it is tested; defaults are the paper's.

    Raises InputError for values that make no experiment.
    """

    n_training_iterations: int = setting(1_000_000, "training iterations of the run", least=0)
    iterations_per_episode: int = setting(10, "iterations of a training episode", least=1)
    iterations_per_trial: int = setting(20, "iterations of a test trial", least=1)
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
    start_error_deg: tuple[float, ...] = setting(
        (3.0, 1.5, 4.0),
        "with a command for each muscle: largest horizontal, vertical and cyclovergence error at"
        " the start of an episode; those that commands can change are drawn uniformly",
        "deg",
        least=0,
        most=20,
        n_entries=3,
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
    fixation_iterations: int = setting(
        0, "iterations of a fixation; 0: the eyes make no saccades (D22)", least=0
    )
    measures_turns: bool = setting(
        False, "whether turns of the eyes are measured without saccades, too (D23)"
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
    command_space: str = setting(
        PAIR, "muscles that a command moves", choices=tuple(COMMAND_SPACES)
    )
    lowest_activations: tuple[float, ...] = setting(
        LOWEST_ACTIVATIONS,
        "lowest initial activation of each command, or one for all",
        least=0,
        most=1,
    )
    highest_activations: tuple[float, ...] = setting(
        HIGHEST_ACTIVATIONS,
        "highest initial activation of each command, or one for all",
        least=0,
        most=1,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range, and numbers that do not fit together."""
        check_settings(self)
        activation_limits(self.space, self.lowest_activations, self.highest_activations)
        if self.n_training_iterations % self.iterations_per_episode:
            raise InputError(
                f"n_training_iterations: expected a multiple of {self.iterations_per_episode} "
                f"(iterations per episode), got {self.n_training_iterations}"
            )
        if self.fixation_iterations and self.command_space != ALL_MUSCLES:
            raise InputError(
                f"fixation_iterations: expected 0 with command_space {self.command_space}, since "
                f"saccades turn each eye about all axes, got {self.fixation_iterations}"
            )
        for name in ("iterations_per_episode", "iterations_per_trial"):
            if self.fixation_iterations and getattr(self, name) % self.fixation_iterations:
                raise InputError(
                    f"{name}: expected a multiple of {self.fixation_iterations} "
                    f"(fixation_iterations), got {getattr(self, name)}"
                )
        if any(n % self.iterations_per_episode for n in self.test_iterations):
            raise InputError(
                f"test_iterations: expected multiples of {self.iterations_per_episode}, "
                f"got {list(self.test_iterations)}"
            )
        if self.n_stimuli_per_test > self.n_test_stimuli:
            raise InputError(
                f"n_stimuli_per_test: expected {self.n_test_stimuli} or less, "
                f"got {self.n_stimuli_per_test}"
            )

    @property
    def space(self) -> CommandSpace:
        """The command space that was chosen."""
        return COMMAND_SPACES[self.command_space]

    @property
    def limits(self) -> Limits:
        """Of the first activation of each command."""
        return activation_limits(self.space, self.lowest_activations, self.highest_activations)

    @property
    def pair_limits(self) -> PairLimits:
        """((lowest, highest) medial, (lowest, highest) lateral) first activations."""
        return pair_limits(self.limits.lowest, self.limits.highest)


@dataclass(frozen=True)
class ExperimentManagerConfig:
    """Settings of one run; raises InputError for a value out of range."""

    seed: int = setting(1, "seed of episodes and trials")
    model: str = setting("M", "model, for the results", choices=MODELS)
    profile: str = setting("", "name of the run's profile, for the results; empty: none")
    metabolic_cost_weight: float = setting(
        0.0, "lambda, price of energy in the reward, the same as the sparse coder's", "1/W", least=0
    )
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
        1000, "record pictures and features of every n-th training episode; 0: of none", least=0
    )
    pictures_every_n_trials: int = setting(
        230,
        "record pictures and features of every n-th test trial; 0: of none (a test has 39"
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
    schedule: str = setting(
        "",
        "changes of the plant during the run, as YAML or JSON:"
        " [{at: ITERATION, set: {NODE.PARAMETER: value}}]; empty: none",
    )
    protocol: ProtocolConfig = field(default_factory=ProtocolConfig)
    # As the plant has them, for the first activations of an episode.
    mechanics: MechanicsConfig = field(default_factory=MechanicsConfig)
    camera: CameraTurns = field(default_factory=CameraTurns)

    def __post_init__(self) -> None:
        """Refuse values out of range, and a schedule that the run or the plant cannot keep."""
        check_settings(self)
        schedule = read_schedule(self.schedule)
        check_places(
            schedule, self.protocol.n_training_iterations, self.protocol.iterations_per_episode
        )
        schedule.plants(self.plant)

    @property
    def plant(self) -> EyePlantConfig:
        """Of the plant's configuration what the first activations of episodes depend on."""
        camera = CameraConfig(**dataclasses.asdict(self.camera))
        return EyePlantConfig(mechanics=self.mechanics, camera=camera)
