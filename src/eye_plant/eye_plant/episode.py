"""One episode, as it is requested: what is shown, from where, and how it is numbered."""

import dataclasses
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from lockstep.command_space import MUSCLE_NAMES
from lockstep.configuration import typed
from lockstep.errors import InputError
from lockstep.settings import REQUIRED, check_settings, setting
from lockstep.wire.topics import TEST, TRAINING


@dataclass(frozen=True)
class Episode:
    """A plane at one distance with one stimulus, and the eyes' first activations.

    Raises InputError for values out of range.
    """

    phase: int = setting(REQUIRED, "0 training, 1 test", least=TRAINING, most=TEST)
    test: int = setting(REQUIRED, "number of the test; -1 in training", least=-1)
    trial: int = setting(REQUIRED, "number of the trial in its test; -1 in training", least=-1)
    episode: int = setting(REQUIRED, "training episodes before this one", least=0)
    training_iteration: int = setting(
        REQUIRED, "training iterations before the first observation", least=0
    )
    stimulus: int = setting(
        REQUIRED, "number of the stimulus, training stimuli first, then test stimuli", least=0
    )
    object_distance_m: float = setting(REQUIRED, "distance of the plane", "m", above=0)
    activations: tuple[float, ...] = setting(
        REQUIRED,
        "first activations of the twelve muscles, in the order of muscle_activations",
        least=0,
        most=1,
        n_entries=len(MUSCLE_NAMES),
    )
    n_iterations: int = setting(REQUIRED, "iterations of the episode", least=1)
    first_observation: int = setting(
        REQUIRED, "number that the run gives to the first observation", least=0
    )

    def __post_init__(self) -> None:
        """Check the ranges that do not depend on the plant."""
        check_settings(self)

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
