"""A rule that turns the eyes: in which units it is told of turns, and asks for them."""

from unittest.mock import Mock

import numpy as np

from tests.vergence_rl.gaze.test_control import HIGHEST, LOWEST, MID
from vergence_rl import Decision, TimeStep
from vergence_rl.gaze.config import GazeConfig
from vergence_rl.gaze.control import GazeControl
from vergence_rl.gaze.turning import TurningRule

WANTED = np.array([0.3, -0.2, 0.1])


def _decision(seen: TimeStep, **_: object) -> Decision:
    return Decision(seen.activations + WANTED, WANTED, 0.0, 0.0, 0.0, 0.0, 0.0)


def test_a_degree_of_torsion_counts_as_its_weight_says() -> None:
    rule = Mock(step=Mock(side_effect=_decision))
    control = GazeControl(LOWEST, HIGHEST, GazeConfig(torsion_weight=0.25), holds_gaze=True)
    control.verge = Mock(return_value=MID)  # type: ignore[method-assign]
    turning = TurningRule(rule, control, 4, 1)
    for i in range(3):
        turning.step(TimeStep(i, i, np.ones(1), MID, -0.1), learning=False, draw=None)
    asked_deg = [call.args[1] for call in control.verge.call_args_list]
    np.testing.assert_allclose(asked_deg, [[0.3, -0.2, 0.4]] * 3)
    # Of the first visit and the next: by then the eyes have turned once.
    places = [call.args[0].activations for call in rule.step.call_args_list]
    np.testing.assert_allclose(places[1:], [np.zeros(3), WANTED])
