"""A learning rule that turns the eyes, in place of changing activations (D22, D23)."""

import dataclasses
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vergence_rl.gaze.control import GazeControl
from vergence_rl.gaze.eye_turns import N_TURNS
from vergence_rl.learning_rule import Decision, LearningRule, TimeStep


class TurningRule:
    """Stands between a rule and the muscles: it makes saccades and leaves vergence to the rule.

    The rule sees what follows the saccades, or the first command, as an episode of its own, in
    which the place of the eyes is the sum of the turns that it has asked for. Its rewards are
    without the energy penalty: the control lowers that, and leaves the vergence that the rule has
    chosen.
    """

    def __init__(
        self, rule: LearningRule, control: GazeControl, iterations_per_fixation: int, n_before: int
    ) -> None:
        """Combine a rule and a control.

        rule: of a task whose commands are turns in deg, times the control's weights.
        iterations_per_fixation: or of an episode without saccades.
        n_before: the first of them, from which the rule does not learn.
        """
        self._rule, self._control = rule, control
        self._n_iterations, self._n_before = iterations_per_fixation, n_before
        # The sum of what vergence has asked for in this fixation.
        self._turned_deg = np.zeros(N_TURNS)

    def step(
        self, observation: TimeStep, *, learning: bool, draw: np.random.Generator | None
    ) -> Decision:
        """Make a saccade where there is a target, otherwise verge where the eyes look."""
        control, activations = self._control, observation.activations
        control.see(observation, learning=learning)
        is_saccade = bool(np.isfinite(observation.target_deg).all())
        # Negative before the rule's first visit.
        since = observation.iteration % self._n_iterations - self._n_before
        if since <= 0:
            self._turned_deg = np.zeros(N_TURNS)
        decision = self._rule.step(
            dataclasses.replace(
                observation,
                iteration=since,
                activations=self._turned_deg * control.weights,
                reward=observation.reward + observation.energy_penalty,
            ),
            learning=learning and not is_saccade and since >= 0 and control.is_known,
            draw=None if is_saccade else draw,
        )
        if is_saccade:
            # The second one corrects the first, without noise.
            is_first = since == -self._n_before
            command = control.saccade(
                activations, observation.target_deg, draw if is_first else None
            )
        else:
            self._turned_deg = decision.command / control.weights
            turn_deg = decision.action / control.weights
            command = control.verge(activations, turn_deg, observation.leading_eye)
            # Turns are learned from commands with noise.
            is_shaken = not control.holds_gaze and (since < 0 or not control.is_known)
            if is_shaken and draw is not None:
                command = control.shaken(command, draw)
        return dataclasses.replace(decision, command=command, action=command - activations)

    def state(self) -> dict[str, NDArray[Any]]:
        """Return all that rule and control have learned, as copies."""
        return self._rule.state() | self._control.state()

    def restore(self, state: Mapping[str, NDArray[Any]]) -> None:
        """Continue from what state returned, with the next episode."""
        self._rule.restore(state)
        self._control.restore(state)
