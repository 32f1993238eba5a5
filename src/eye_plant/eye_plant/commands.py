"""From the names and values of a muscle command to the target activations of all muscles."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from lockstep import InputError
from lockstep.command_space import ACTIVATION_NAMES, muscles_of


def target_activations(
    names: Sequence[str], values: np.ndarray, held_activations: np.ndarray
) -> np.ndarray:
    """Return the target activations of a command, of as many muscles as are held.

    names: `left_medial_rectus` names one muscle, `medial_rectus` that muscle of both eyes; values:
    (n,) activations in [0, 1]; held_activations: (12,), or (16,) of eyes with lenses, kept by
    muscles without a name in the command. Raises InputError for no name, an unknown name, a muscle
    named twice, another number of values than names, and a value out of range.
    """
    if not len(names) or len(values) != len(names):
        raise InputError(
            f"muscle_command: expected one position per name and at least one, "
            f"got {len(values)} for {len(names)} names"
        )
    if not ((values >= 0.0) & (values <= 1.0)).all():
        raise InputError(
            f"muscle_command: expected activations in [0, 1], got {np.asarray(values).tolist()}"
        )
    targets = held_activations.copy()
    plant_names = ACTIVATION_NAMES[: len(held_activations)]
    i_muscles, i_values = _wiring(tuple(names), plant_names)
    targets[i_muscles] = values[i_values]
    return targets


@lru_cache(maxsize=8)  # the same few names come each time
def _wiring(names: tuple[str, ...], plant_names: tuple[str, ...]) -> tuple[list[int], list[int]]:
    """Return which muscles are commanded, and by which of the names."""
    i_muscles: list[int] = []
    i_values: list[int] = []
    for i_value, name in enumerate(names):
        muscles = muscles_of(name)
        if not set(muscles) <= set(plant_names):
            raise InputError(
                f"muscle_command: unknown muscle {name!r}, expected some of "
                f"{', '.join(plant_names)}, or one without its side for both eyes"
            )
        indices = [plant_names.index(muscle) for muscle in muscles]
        if not set(i_muscles).isdisjoint(indices):
            raise InputError(f"muscle_command: expected each muscle once, got {name!r} again")
        i_muscles += indices
        i_values += [i_value] * len(indices)
    return i_muscles, i_values
