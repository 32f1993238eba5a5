"""Saccades of both eyes, and commands of vergence that leave the gaze where it is."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep.command_space import SIDES
from lockstep.errors import InputError
from vergence_rl.gaze.eye_turns import N_TURNS, EyeTurns

Floats = NDArray[np.float64]

# The target is a place in the left picture, so it is the left eye's line of sight that is held.
_LEFT = 0
_SIDEWAYS_AND_UP = np.zeros(2)


class GazeControl:
    """Owns what is known of both eyes' turns.

    Activations are those of twelve muscles, the left eye's six first.
    """

    def __init__(self, lowest: Floats, highest: Floats, saccade_noise: float) -> None:
        """lowest, highest: (12,) limits of the commands; see GazeConfig."""
        self._noise, self._limits = saccade_noise, (lowest, highest)
        self._eyes = [
            EyeTurns(low, high)
            for low, high in zip(_of_eyes(lowest), _of_eyes(highest), strict=True)
        ]
        self._before: Floats | None = None

    def forget_movement(self) -> None:
        """Learn nothing from what comes next until there was another command."""
        self._before = None

    def learn(self, activations: Floats, turns_deg: Floats) -> None:
        """Learn from the last command, which led to these activations (12,).

        turns_deg: (2, n_turns) of each eye, NaN where it was not seen clearly.
        """
        if self._before is None:
            return
        before, after = _of_eyes(self._before), _of_eyes(activations)
        for eye, a, b, turned_deg in zip(self._eyes, before, after, turns_deg, strict=True):
            if np.isfinite(turned_deg).all():
                eye.learn(a, b - a, turned_deg)
        self._before = None

    def saccade(
        self, activations: Floats, target_deg: Floats, draw: np.random.Generator | None
    ) -> Floats:
        """Return the command (12,) that turns both eyes alike toward a target.

        target_deg: (2,) sideways and up from the left line of sight. Neither eye is to rotate about
        its line of sight, so that torsion is not left to chance. draw: the source of noise, None
        for none.
        """
        self._before = activations
        wanted_deg = np.append(target_deg, 0.0)
        of_eyes = zip(self._eyes, _of_eyes(activations), strict=True)
        change = np.concatenate([eye.change(a, wanted_deg) for eye, a in of_eyes])
        if draw is not None:
            change += draw.normal(0.0, self._noise, len(change))
        return np.clip(activations + change, *self._limits)

    def held(self, activations: Floats, command: Floats) -> Floats:
        """Return the nearest command (12,) that leaves the left eye's line of sight where it is."""
        self._before = activations
        a, c = _of_eyes(activations)[_LEFT], _of_eyes(command)[_LEFT]
        change = self._eyes[_LEFT].change(a, _SIDEWAYS_AND_UP, c - a)
        return np.clip(np.concatenate([a + change, _of_eyes(command)[1]]), *self._limits)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, as copies."""
        return {
            f"{side}_eye_{name}": array
            for side, eye in zip(SIDES, self._eyes, strict=True)
            for name, array in eye.state().items()
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit."""
        for side, eye in zip(SIDES, self._eyes, strict=True):
            eye.restore({name: state[f"{side}_eye_{name}"] for name in eye.state()})
        self._before = None


def checked_gaze(target_deg: Floats, turns_deg: Floats) -> tuple[Floats, Floats]:
    """Return a target (2,) and both eyes' turns (2, n_turns) as arrays; InputError otherwise."""
    target_deg, turns_deg = np.asarray(target_deg, np.float64), np.asarray(turns_deg, np.float64)
    if target_deg.shape != (2,) or turns_deg.shape != (len(SIDES), N_TURNS):
        raise InputError(
            f"gaze: expected a target (2,) and turns ({len(SIDES)}, {N_TURNS}), got shapes "
            f"{target_deg.shape} and {turns_deg.shape}"
        )
    if np.isinf(target_deg).any() or np.isinf(turns_deg).any():
        raise InputError("gaze: expected finite numbers, or NaN where there is none")
    return target_deg, turns_deg


def _of_eyes(values: Floats) -> Floats:
    """Return values (12,) by eye, (2, 6)."""
    return values.reshape(len(SIDES), -1)
