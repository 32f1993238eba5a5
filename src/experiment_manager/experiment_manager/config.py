"""Settings of the experiment manager."""

import math
from dataclasses import dataclass, field

from experiment_manager.protocol import ProtocolConfig
from eye_plant.model import MechanicsConfig
from lockstep.errors import InputError

MODELS = ("M", "M_C")


@dataclass(frozen=True)
class ExperimentManagerConfig:
    """Settings of one run.

    seed: of episodes and trials; model: M or M_C, for the results; metabolic_cost_weight: lambda
    in 1/W, as the sparse coder has it; run_directory: where the run is written ("": a new one
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
