"""Settings of the experiment manager."""

import math
from dataclasses import dataclass, field

from eye_plant.mechanics.model import MechanicsConfig
from lockstep.errors import InputError

MODELS = ("M", "M_C")

# K17: 13 tests; the times are the authors' (public code), given here for 10^6 iterations.
PAPER_TEST_ITERATIONS = (
    *range(0, 200_001, 50_000),
    *range(300_000, 1_000_001, 100_000),
)


_LEAST_DISTANCE_M = 0.1
# Parameters that are a lowest and a highest value, and the least that either may be.
_BOUNDS = {
    "object_distance_m": _LEAST_DISTANCE_M,
    "fixation_distance_m": _LEAST_DISTANCE_M,
    "medial_rectus_limits": 0.0,
    "lateral_rectus_limits": 0.0,
}


@dataclass(frozen=True)
class ProtocolConfig:
    """What is shown, how long, and when it is tested; defaults are the paper's.

    test_iterations: training iterations before each test, those beyond the end are left out and
    one at the end is always made; n_stimuli_per_test: the first so many of the test stimuli;
    the limits bound the activations that an episode starts with.
    Raises InputError for values that make no experiment.
    """

    n_training_iterations: int = 1_000_000
    iterations_per_episode: int = 10
    iterations_per_trial: int = 20
    test_iterations: tuple[int, ...] = PAPER_TEST_ITERATIONS
    n_training_stimuli: int = 100
    n_test_stimuli: int = 40
    n_stimuli_per_test: int = 40
    object_distance_m: tuple[float, ...] = (0.5, 6.0)
    fixation_distance_m: tuple[float, ...] = (0.5, 6.0)
    test_distances_m: tuple[float, ...] = (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    least_start_error_deg: int = -3
    medial_rectus_limits: tuple[float, ...] = (0.0, 0.2)
    lateral_rectus_limits: tuple[float, ...] = (0.0, 0.1)

    def __post_init__(self) -> None:
        """Check that the numbers fit together."""
        counts = (
            "iterations_per_episode",
            "iterations_per_trial",
            "n_training_stimuli",
            "n_test_stimuli",
            "n_stimuli_per_test",
        )
        for name in counts:
            if getattr(self, name) < 1:
                raise InputError(f"{name}: expected 1 or more, got {getattr(self, name)}")
        if self.n_training_iterations < 0 or (
            self.n_training_iterations % self.iterations_per_episode
        ):
            raise InputError(
                f"n_training_iterations: expected a multiple of {self.iterations_per_episode} "
                f"(iterations per episode), got {self.n_training_iterations}"
            )
        if any(n % self.iterations_per_episode or n < 0 for n in self.test_iterations):
            raise InputError(
                f"test_iterations: expected multiples of {self.iterations_per_episode}, "
                f"got {list(self.test_iterations)}"
            )
        if self.n_stimuli_per_test > self.n_test_stimuli:
            raise InputError(
                f"n_stimuli_per_test: expected {self.n_test_stimuli} or less, "
                f"got {self.n_stimuli_per_test}"
            )
        for name, least in _BOUNDS.items():
            values = getattr(self, name)
            if len(values) != 2 or not least <= values[0] <= values[1] < math.inf:
                raise InputError(
                    f"{name}: expected [lowest, highest] from {least} on, got {list(values)}"
                )
        if not all(_LEAST_DISTANCE_M <= d < math.inf for d in self.test_distances_m):
            raise InputError(
                f"test_distances_m: expected {_LEAST_DISTANCE_M} m or more, "
                f"got {list(self.test_distances_m)}"
            )
        if self.least_start_error_deg > 0:
            raise InputError(
                f"least_start_error_deg: expected 0 or less, got {self.least_start_error_deg}"
            )


def bounds(values: tuple[float, ...]) -> tuple[float, float]:
    """Return a parameter's [lowest, highest] as a pair."""
    lowest, highest = values
    return lowest, highest


@dataclass(frozen=True)
class ExperimentManagerConfig:
    """Settings of one run.

    seed: of episodes and trials; model: M or M_C, for the results; profile: the named settings that
    the run began with ("": none), for the results; metabolic_cost_weight: lambda in 1/W, as the
    sparse coder has it; run_directory: where the run is written ("": a new one
    under runs/); run_id: what requests carry ("": the directory's name); commit: of the source;
    checkpoint_period_s: steady time between checkpoints; gap_s: without a new message for so long,
    the run has a fault; pictures_every_n_episodes, pictures_every_n_trials: 0 records none (a test
    has 39 conditions per stimulus: a multiple of 39 would show one condition alone);
    resume: continue from the newest checkpoint of the run directory; supervised: somebody starts
    all nodes again after a fault, so that what could be waited out is one too; mechanics: as the
    plant has it, for the first activations of an episode.
    Raises InputError for a value out of range.
    """

    seed: int = 1
    model: str = "M"
    profile: str = ""
    metabolic_cost_weight: float = 0.0
    run_directory: str = ""
    run_id: str = ""
    commit: str = ""
    checkpoint_period_s: float = 120.0
    gap_s: float = 5.0
    pictures_every_n_episodes: int = 1000
    pictures_every_n_trials: int = 230
    resume: bool = False
    supervised: bool = False
    protocol: ProtocolConfig = field(default_factory=ProtocolConfig)
    mechanics: MechanicsConfig = field(default_factory=MechanicsConfig)

    def __post_init__(self) -> None:
        """Check the ranges."""
        if self.model not in MODELS:
            raise InputError(f"model: expected {' or '.join(MODELS)}, got {self.model!r}")
        weight = self.metabolic_cost_weight
        if not (math.isfinite(weight) and weight >= 0.0):
            raise InputError(
                f"metabolic_cost_weight: expected a finite number, 0 or more, got {weight}"
            )
        for name in ("checkpoint_period_s", "gap_s"):
            if not getattr(self, name) > 0.0:
                raise InputError(f"{name}: expected more than 0 s, got {getattr(self, name)}")
        for name in ("pictures_every_n_episodes", "pictures_every_n_trials"):
            if getattr(self, name) < 0:
                raise InputError(f"{name}: expected 0 or more, got {getattr(self, name)}")
