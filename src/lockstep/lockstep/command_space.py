"""What a command moves, and within which limits: the spaces that a configuration chooses.

The plant has twelve muscles that turn the eyes, and four within the eyes: a ciliary muscle, which
focuses the lens, and the sphincter of a pupil in each. A command names activations; each is that of
one muscle, or the same for the muscle of that name in both eyes. A robot's head has joints instead,
whose angles in rad a command names.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from lockstep.errors import InputError

SIDES = ("left", "right")
MUSCLES = (
    "medial_rectus",
    "lateral_rectus",
    "superior_rectus",
    "inferior_rectus",
    "superior_oblique",
    "inferior_oblique",
)
MUSCLE_NAMES = tuple(f"{side}_{muscle}" for side in SIDES for muscle in MUSCLES)
CILIARY, SPHINCTER = "ciliary", "sphincter"
INTRAOCULAR_NAMES = tuple(f"{side}_{muscle}" for side in SIDES for muscle in (CILIARY, SPHINCTER))
ACTIVATION_NAMES = (*MUSCLE_NAMES, *INTRAOCULAR_NAMES)

# Of the pair. K17's restriction of both activations, throughout: its code restricts the initial
# draw only (D5).
LOWEST_ACTIVATIONS, HIGHEST_ACTIVATIONS = (0.0, 0.0), (0.2, 0.1)


@dataclass(frozen=True)
class CommandSpace:
    """Names of what a command sets: activations of muscles or of pairs of them, or angles.

    of_joints: whether these are angles of a head's joints, in rad. Wherever muscles are spoken of,
    the joints take their places then, each as it is.
    """

    names: tuple[str, ...]
    of_joints: bool = False

    @property
    def n_eyes(self) -> int:
        """Eyes with activations of their own: 1 where both are commanded alike, or by joints."""
        return len(SIDES) if set(self.names) <= set(ACTIVATION_NAMES) else 1

    @cached_property
    def muscle_names(self) -> tuple[str, ...]:
        """The muscles that are commanded, in the order of ACTIVATION_NAMES."""
        if self.of_joints:
            return self.names
        commanded = {muscle for name in self.names for muscle in muscles_of(name)}
        return tuple(muscle for muscle in ACTIVATION_NAMES if muscle in commanded)

    @cached_property
    def has_lenses(self) -> bool:
        """Whether a muscle within the eyes is commanded, so that pictures may be out of focus."""
        return not set(self.muscle_names).isdisjoint(INTRAOCULAR_NAMES)

    @property
    def activation_names(self) -> tuple[str, ...]:
        """The muscles whose activations the plant tells, in their order."""
        return ACTIVATION_NAMES if self.has_lenses else MUSCLE_NAMES

    @cached_property
    def turning(self) -> "CommandSpace":
        """The space of what turns the eyes alone; its names come first in a command."""
        if self.of_joints or not self.has_lenses:
            return self
        return CommandSpace(
            tuple(n for n in self.names if set(muscles_of(n)).isdisjoint(INTRAOCULAR_NAMES))
        )

    @cached_property
    def indices(self) -> NDArray[np.intp]:
        """Positions of muscle_names among ACTIVATION_NAMES, or of joints among themselves."""
        if self.of_joints:
            return np.arange(len(self.names))
        return np.array([ACTIVATION_NAMES.index(muscle) for muscle in self.muscle_names])

    @cached_property
    def _members(self) -> NDArray[np.intp]:
        """For each name the positions of its muscles among muscle_names."""
        if self.of_joints:
            return np.arange(len(self.names))[:, None]
        members = [[self.muscle_names.index(m) for m in muscles_of(name)] for name in self.names]
        # A muscle of its own among pairs is there twice: the mean is the same.
        widest = max(map(len, members))
        return np.array([of_name * (widest // len(of_name)) for of_name in members])

    def from_muscles(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (..., n_names) from values (..., n_muscles) of muscle_names.

        Of muscles that share a name it is the mean.
        """
        means: NDArray[np.float64] = values[..., self._members].mean(axis=-1)
        return means

    def from_all(self, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return (..., n_names) from values (..., n) of activation_names."""
        return self.from_muscles(values[..., self.indices])


@dataclass(frozen=True)
class Limits:
    """The least and the largest value of each command."""

    lowest: tuple[float, ...]
    highest: tuple[float, ...]


def muscles_of(name: str) -> tuple[str, ...]:
    """Return the muscle of a name, or those of that name in both eyes."""
    return (name,) if name in ACTIVATION_NAMES else tuple(f"{side}_{name}" for side in SIDES)


def activation_limits(
    space: CommandSpace, lowest: Sequence[float], highest: Sequence[float]
) -> Limits:
    """Return the limits of each command; lowest, highest: one entry a command, or one for all.

    Joints have those that their head declares, and none here. Raises InputError for another number
    of entries, and where the least exceeds the largest.
    """
    if space.of_joints:
        n_joints = len(space.names)
        return Limits((-math.inf,) * n_joints, (math.inf,) * n_joints)
    limits = Limits(
        _one_each("lowest_activations", lowest, space),
        _one_each("highest_activations", highest, space),
    )
    for name, low, high in zip(space.names, limits.lowest, limits.highest, strict=True):
        if low > high:
            raise InputError(
                f"highest_activations: expected {low} or more for {name}, the least one, got {high}"
            )
    return limits


def _one_each(parameter: str, values: Sequence[float], space: CommandSpace) -> tuple[float, ...]:
    n_names = len(space.names)
    if len(values) not in (1, n_names):
        raise InputError(
            f"{parameter}: expected {n_names} entries, of {', '.join(space.names)}, or one for "
            f"all, got {list(values)}"
        )
    return tuple(values) if len(values) == n_names else (values[0],) * n_names


PAIR, HORIZONTAL_RECTI, ALL_MUSCLES = "pair", "horizontal_recti", "all_muscles"
PAIR_AND_LENS, PAIR_AND_LENSES = "pair_and_lens", "pair_and_lenses"
ALL_MUSCLES_AND_LENSES = "all_muscles_and_lenses"
VERGENCE, PAN_TILT_VERGENCE = "vergence", "pan_tilt_vergence"
COMMAND_SPACES = {
    # Both eyes alike, as in K17.
    PAIR: CommandSpace(("medial_rectus", "lateral_rectus")),
    # Each eye its own (D19): it may turn sideways ...
    HORIZONTAL_RECTI: CommandSpace(
        tuple(f"{side}_{muscle}" for side in SIDES for muscle in MUSCLES[:2])
    ),
    # ... and about all three axes.
    ALL_MUSCLES: CommandSpace(MUSCLE_NAMES),
    # The same with lenses: one command for both, or one each.
    PAIR_AND_LENS: CommandSpace(("medial_rectus", "lateral_rectus", CILIARY)),
    PAIR_AND_LENSES: CommandSpace(("medial_rectus", "lateral_rectus", *INTRAOCULAR_NAMES[::2])),
    ALL_MUSCLES_AND_LENSES: CommandSpace((*MUSCLE_NAMES, *INTRAOCULAR_NAMES[::2])),
    # A robot's head: the sum of both cameras' turns toward each other, and those of its neck.
    VERGENCE: CommandSpace(("vergence",), of_joints=True),
    PAN_TILT_VERGENCE: CommandSpace(("pan", "tilt", "vergence"), of_joints=True),
}
