"""One episode, as it is requested: what is shown, from where, and how it is numbered."""

import dataclasses
import typing
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lockstep import MUSCLE_NAMES, InputError, check_settings, setting
from lockstep.command_space import ACTIVATION_NAMES
from lockstep.configuration import typed
from lockstep.randomness import Moment
from lockstep.settings import REQUIRED
from lockstep.wire.topics import TEST, TRAINING

# Arguments that not every plant has.
_LISTS = {"activations", "joints_rad", "targets_deg"}


@dataclass(frozen=True)
class Episode:
    """A plane at one distance with one stimulus, and the eyes' first activations.

    Of a robot's head the first angles of its joints instead. Raises InputError for values out of
    range.
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
    n_iterations: int = setting(REQUIRED, "iterations of the episode", least=1)
    first_observation: int = setting(
        REQUIRED, "number that the run gives to the first observation", least=0
    )
    activations: tuple[float, ...] = setting(
        (),
        "first activations of the twelve muscles, in the order of muscle_activations, and of those"
        " within the eyes, or these are at rest; none of a robot's head",
        least=0,
        most=1,
    )
    joints_rad: tuple[float, ...] = setting(
        (),
        "first angles of the joints of a robot's head, in the order of the command space",
        "rad",
    )
    targets_deg: tuple[float, ...] = setting(
        (),
        "gaze targets, azimuth (right) and elevation of each from the left eye, one after the other"
        " for equal parts of the episode; none where the eyes make no saccades or choose",
        "deg",
        least=-90,
        most=90,
    )

    def __post_init__(self) -> None:
        """Check the ranges that do not depend on the plant."""
        check_settings(self)
        counts = (0,) if self.joints_rad else (len(MUSCLE_NAMES), len(ACTIVATION_NAMES))
        if len(self.activations) not in counts:
            raise InputError(
                f"activations: expected those of {len(MUSCLE_NAMES)} muscles, or joints_rad, got "
                f"{len(self.activations)} activations and {len(self.joints_rad)} angles"
            )
        if len(self.targets_deg) % 2 or self.n_targets > self.n_iterations:
            raise InputError(
                f"targets_deg: expected azimuth and elevation of {self.n_iterations} targets or "
                f"less, got {len(self.targets_deg)} numbers"
            )

    @classmethod
    def alone(
        cls,
        stimulus: int,
        object_distance_m: float,
        activations: Sequence[float],
        n_iterations: int,
        targets_deg: Sequence[float] = (),
    ) -> "Episode":
        """Return an episode of no run, in which nothing is to be learned; raises InputError."""
        return cls(
            phase=TEST,
            test=-1,
            trial=-1,
            episode=0,
            training_iteration=0,
            stimulus=stimulus,
            object_distance_m=object_distance_m,
            activations=tuple(activations),
            n_iterations=n_iterations,
            first_observation=0,
            targets_deg=tuple(targets_deg),
        )

    def moment(self, iteration: int) -> Moment:
        """Return which observation of the run that of an iteration is."""
        since = iteration if self.phase == TRAINING else 0
        return Moment(self.trial, iteration, self.training_iteration + since)

    @property
    def n_targets(self) -> int:
        """Gaze targets of the episode."""
        return len(self.targets_deg) // 2

    def target_deg(self, iteration: int) -> tuple[float, float] | None:
        """Return azimuth and elevation of the target at an iteration, None where there is none.

        The last one remains the target for what is left of the episode.
        """
        if not self.n_targets:
            return None
        per_target = self.n_iterations // self.n_targets
        i = min(iteration // per_target, self.n_targets - 1)
        return self.targets_deg[2 * i], self.targets_deg[2 * i + 1]

    def begins_fixation(self, iteration: int) -> bool:
        """Whether the target at an iteration is a new one."""
        if not self.n_targets:
            return False
        i_target, since = divmod(iteration, self.n_iterations // self.n_targets)
        return i_target < self.n_targets and since == 0

    @classmethod
    def from_arguments(cls, arguments: Mapping[str, Any]) -> "Episode":
        """Return the episode of a request's arguments, by field name; lists may be missing.

        Raises InputError for missing, unknown, mistyped or out-of-range arguments.
        """
        hints = typing.get_type_hints(cls)
        missing = sorted(set(hints) - _LISTS - set(arguments))
        unknown = sorted(set(arguments) - set(hints))
        if missing or unknown:
            raise InputError(
                f"episode: expected {', '.join(hints)}; missing: {', '.join(missing) or 'none'}, "
                f"unknown: {', '.join(unknown) or 'none'}"
            )
        return cls(**{name: typed(name, hints[name], value) for name, value in arguments.items()})

    def as_arguments(self) -> dict[str, Any]:
        """Return the arguments of a request for this episode."""
        arguments = dataclasses.asdict(self)
        # An empty list has no type among ROS parameters.
        return {n: v for n, v in arguments.items() if v or n not in _LISTS}
