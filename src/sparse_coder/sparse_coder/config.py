"""Settings of the sparse coder."""

import math
from dataclasses import dataclass

from lockstep.errors import InputError


@dataclass(frozen=True)
class SparseCoderConfig:
    """Settings of the sparse coder; the defaults are the published model's (K17 II).

    seed: of the initial dictionaries; n_bases: atoms per scale; n_selections: matching pursuit's
    selections per patch; learning_rate: eta of the dictionaries; metabolic_cost_weight: lambda of
    K17 eq. 5 in 1/W, 0 is the model M without a price on energy.
    Raises InputError for a value out of range.
    """

    seed: int = 1
    n_bases: int = 400
    n_selections: int = 10
    learning_rate: float = 0.2
    metabolic_cost_weight: float = 0.0

    def __post_init__(self) -> None:
        """Refuse what no run can mean."""
        for name in ("n_bases", "n_selections"):
            if getattr(self, name) < 1:
                raise InputError(f"{name}: expected 1 or more, got {getattr(self, name)}")
        for name in ("learning_rate", "metabolic_cost_weight"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InputError(f"{name}: expected a finite number, 0 or more, got {value}")
