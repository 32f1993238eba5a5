"""One episode, as it is requested: what is shown, from where, and how it is numbered."""

import dataclasses
import math
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lockstep.configuration import typed
from lockstep.errors import InputError
from lockstep.topics import TEST, TRAINING


@dataclass(frozen=True)
class Episode:
    """A plane at one distance with one stimulus, and the eyes' first muscle activations.

    phase: 0 training, 1 test; test, trial: -1 in training; episode: training episodes before this
    one; training_iteration: training iterations before the first observation; stimulus: training
    stimuli first, then test stimuli; medial_rectus, lateral_rectus: activations in [0, 1] of both
    eyes; first_observation: the number that the run gives to the first observation.
    Raises InputError for values out of range.
    """

    phase: int
    test: int
    trial: int
    episode: int
    training_iteration: int
    stimulus: int
    object_distance_m: float
    medial_rectus: float
    lateral_rectus: float
    n_iterations: int
    first_observation: int

    def __post_init__(self) -> None:
        """Check the ranges that do not depend on the plant."""
        if self.phase not in (TRAINING, TEST):
            raise InputError(f"phase: expected 0 (training) or 1 (test), got {self.phase}")
        for name in ("episode", "training_iteration", "stimulus", "first_observation"):
            if getattr(self, name) < 0:
                raise InputError(f"{name}: expected 0 or more, got {getattr(self, name)}")
        if self.n_iterations < 1:
            raise InputError(f"n_iterations: expected 1 or more, got {self.n_iterations}")
        for name in ("medial_rectus", "lateral_rectus"):
            activation = getattr(self, name)
            if not 0.0 <= activation <= 1.0:
                raise InputError(f"{name}: expected an activation in [0, 1], got {activation}")
        if not (math.isfinite(self.object_distance_m) and self.object_distance_m > 0.0):
            raise InputError(
                f"object_distance_m: expected more than 0 m, got {self.object_distance_m}"
            )

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> "Episode":
        """Return the episode of a request's arguments, by field name; all are expected.

        Raises InputError for missing, unknown, mistyped or out-of-range arguments.
        """
        hints = typing.get_type_hints(cls)
        missing, unknown = sorted(set(hints) - set(arguments)), sorted(set(arguments) - set(hints))
        if missing or unknown:
            raise InputError(
                f"episode: expected {', '.join(hints)}; missing: {', '.join(missing) or 'none'}, "
                f"unknown: {', '.join(unknown) or 'none'}"
            )
        return cls(**{name: typed(name, hint, arguments[name]) for name, hint in hints.items()})

    def as_arguments(self) -> dict[str, Any]:
        """Return the arguments of a request for this episode."""
        return dataclasses.asdict(self)
