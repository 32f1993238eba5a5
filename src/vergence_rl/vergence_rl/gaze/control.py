"""Saccades of both eyes, and vergence for little energy, which may leave the gaze where it is.

Both are turns of the eyes; what is known of how activations turn them makes activations of both
(D22, D23).
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lockstep import SIDES, InputError
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.descent import lowered
from vergence_rl.gaze.effort import Effort
from vergence_rl.gaze.eye_turns import N_TURNS, EyeTurns
from vergence_rl.learning_rule import TimeStep

Floats = NDArray[np.float64]

# By which a command changes an activation at most to save energy.
_LARGEST_SAVING = 0.02
# What makes a turn of each eye one of a left eye: to the right and clockwise are inward for it.
_MIRRORED = np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]])


class GazeControl:
    """Owns what is known of both eyes' turns, and of what activations cost.

    Activations are those of twelve muscles, the left eye's six first. holds_gaze: whether vergence
    leaves the leading eye's line of sight where saccades have turned it. weights: (3,) what a
    degree of each turn of vergence counts as for the rule that chooses it.
    """

    def __init__(
        self, lowest: Floats, highest: Floats, config: GazeConfig, *, holds_gaze: bool
    ) -> None:
        """lowest, highest: (12,) limits of the commands."""
        # Without saccades both eyes verge, and version is free.
        self.holds_gaze = holds_gaze
        self.weights = np.array([1.0, 1.0, config.torsion_weight])
        self._noise, self._limits = config.saccade_noise, (lowest, highest)
        self._eyes = [
            EyeTurns(low, high, config.memory_share)
            for low, high in zip(_of_eyes(lowest), _of_eyes(highest), strict=True)
        ]
        self._signs = np.ones_like(_MIRRORED)
        names = [f"{side}_eye" for side in SIDES]
        if config.equal_innervation:
            # One owner under one name, of both eyes.
            self._eyes, names = self._eyes[:1] * len(SIDES), ["eyes"] * len(SIDES)
            self._signs = _MIRRORED
        self._effort = Effort(len(lowest))
        self._regressions = dict(zip((*names, "effort"), (*self._eyes, self._effort), strict=True))
        self._before: Floats | None = None

    @property
    def is_known(self) -> bool:
        """Whether enough movements of both eyes are known to make turns of them."""
        return all(eye.is_known for eye in self._eyes)

    def see(self, observation: TimeStep, *, learning: bool) -> None:
        """Learn from the last command, which led to this observation, and what its place costs.

        Nothing is learned of a movement from the first observation of an episode.
        """
        before, self._before = self._before, None
        if not learning:
            return
        if observation.energy_penalty:
            self._effort.learn(observation.activations, observation.energy_penalty)
        if before is None or observation.iteration == 0:
            return
        places = _of_eyes(before), _of_eyes(observation.activations)
        turns_deg = self._signs * observation.turns_deg
        for eye, a, b, turned_deg in zip(self._eyes, *places, turns_deg, strict=True):
            if np.isfinite(turned_deg).all():
                eye.learn(a, b - a, turned_deg)

    def saccade(
        self, activations: Floats, target_deg: Floats, draw: np.random.Generator | None
    ) -> Floats:
        """Return the command (12,) that turns both eyes alike toward a target.

        target_deg: (2,) sideways and up from the leading eye's line of sight. Neither eye is to
        rotate about its line of sight, so that torsion is not left to chance. draw: the source of
        noise, None for none.
        """
        self._before = activations
        wanted_deg = np.append(target_deg, 0.0)
        change = self._change(activations, np.array([wanted_deg, wanted_deg]))
        command = np.clip(activations + change, *self._limits)
        return command if draw is None else self.shaken(command, draw)

    def shaken(self, command: Floats, draw: np.random.Generator) -> Floats:
        """Return a command (12,) with noise, from which turns are learned."""
        return np.clip(command + draw.normal(0.0, self._noise, len(command)), *self._limits)

    def verge(self, activations: Floats, turn_deg: Floats, leads: int = 0) -> Floats:
        """Return the command (12,) that turns the eyes against each other, and saves energy.

        turn_deg: (n_turns,) of the right eye against the left one. Each eye makes half of it. Where
        gaze is held, only the eye that does not lead turns sideways and up, since the target is a
        place in the other one's picture. As long as few movements are known, nothing is changed.
        leads: 0 the left eye, 1 the right one.
        """
        self._before = activations
        if not self.is_known:
            return activations
        turned = np.array([-0.5 * turn_deg, 0.5 * turn_deg])
        if self.holds_gaze:
            turned[leads, :-1] = 0.0
            turned[1 - leads, :-1] *= 2.0
        command = activations + self._change(activations, turned)
        slopes = self._effort.slopes(command)
        if slopes.any():
            command = command + self._saving(command, slopes, leads)
        return np.clip(command, *self._limits)

    def _saving(self, command: Floats, slopes: Floats, leads: int) -> Floats:
        """Return the change (12,) of a command that lowers its penalty and leaves the vergence.

        slopes: (12,) of the penalty. What may change is what turns both eyes alike: the rotation
        about their lines of sight and, unless gaze is held, all turns.
        """
        known = zip(self._eyes, _of_eyes(command), self._signs, strict=True)
        of_eyes = [signs[:, None] * eye.slopes_deg(a) for eye, a, signs in known]
        angles = np.hstack([of_eyes[0], -of_eyes[1]])
        if self.holds_gaze:
            of_eyes[1 - leads] = np.zeros_like(of_eyes[1 - leads])
            angles = np.vstack([angles, np.hstack(of_eyes)[:-1]])
        change = lowered(command, slopes, angles, self._limits, _LARGEST_SAVING)
        alike = self._eyes[leads].turns_deg(_of_eyes(command)[leads], _of_eyes(change)[leads])
        alike *= self._signs[leads]
        if self.holds_gaze:
            alike[:-1] = 0.0
        # Exactly so: slopes are those of small changes.
        return self._change(command, np.array([alike, alike]), change)

    def _change(self, activations: Floats, turns_deg: Floats, near: Floats | None = None) -> Floats:
        """Return the change (12,) that turns each eye, (2, n_turns), nearest to `near`, or none."""
        of_eyes = zip(
            self._eyes,
            _of_eyes(activations),
            self._signs * turns_deg,
            _of_eyes(np.zeros_like(activations) if near is None else near),
            strict=True,
        )
        return np.concatenate([eye.change_for(a, turn, n) for eye, a, turn, n in of_eyes])

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that learning has changed, as copies."""
        return {
            f"{owner}_{name}": array
            for owner, regression in self._regressions.items()
            for name, array in regression.state().items()
        }

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, bit for bit."""
        for owner, regression in self._regressions.items():
            regression.restore({name: state[f"{owner}_{name}"] for name in regression.state()})
        self._before = None


def checked_gaze(
    target_deg: Floats, turns_deg: Floats, leading_eye: float
) -> tuple[Floats, Floats, int]:
    """Return a target (2,), both eyes' turns (2, n_turns) and an eye; InputError otherwise."""
    target_deg, turns_deg = np.asarray(target_deg, np.float64), np.asarray(turns_deg, np.float64)
    if target_deg.shape != (2,) or turns_deg.shape != (len(SIDES), N_TURNS):
        raise InputError(
            f"gaze: expected a target (2,) and turns ({len(SIDES)}, {N_TURNS}), got shapes "
            f"{target_deg.shape} and {turns_deg.shape}"
        )
    if np.isinf(target_deg).any() or np.isinf(turns_deg).any():
        raise InputError("gaze: expected finite numbers, or NaN where there is none")
    if leading_eye not in range(len(SIDES)):
        raise InputError(f"leading_eye: expected 0, the left one, or 1, got {leading_eye}")
    return target_deg, turns_deg, int(leading_eye)


def _of_eyes(values: Floats) -> Floats:
    """Return values (12,) by eye, (2, 6)."""
    return values.reshape(len(SIDES), -1)
