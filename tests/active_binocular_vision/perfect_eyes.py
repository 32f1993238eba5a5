"""Eyes that hold the right posture, in focus if they have lenses, whatever they are shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from active_binocular_vision.learners.correct_gaze import AHEAD_DEG, CorrectGaze
from active_binocular_vision.learners.session import NO_PRISM, Course, Eyes
from eye_plant.config import changed
from eye_plant.lens.lenses import Lenses
from lockstep import PAIR
from vergence_rl import Agent, Decision


@contextmanager
def perfect_eyes() -> Iterator[list[np.ndarray]]:
    """Yield the errors (3,) that the pictures have at the end of each look, of eyes so commanded.

    Their activations are those of CorrectGaze at once, for the cameras that a prism has turned and
    for the target; lenses focus as near to the plane as they can.
    """
    observe, look = Agent.observe, Eyes.look
    command: list[np.ndarray] = []
    seen_deg: list[np.ndarray] = []
    known: dict[Any, np.ndarray] = {}

    def turning(eyes: Eyes, prism: Any, target_deg: Any) -> np.ndarray:
        session, distance_m = eyes._session, eyes._distance_m
        learners, parallax_m = session.learners, session.parallax_m(eyes._i_picture)
        left_deg, right_deg = learners.plant.camera.turns_deg
        turned_deg = tuple(a + b for a, b in zip(right_deg, vars(prism).values(), strict=True))
        key = (learners.run, left_deg, turned_deg, parallax_m, distance_m, tuple(target_deg))
        if key not in known:
            protocol, mechanics = learners.manager, learners.plant.mechanics
            correct = CorrectGaze(protocol, mechanics, (left_deg, turned_deg), parallax_m)
            # Of the pair, which does not know of cameras.
            error_deg = left_deg[0] + turned_deg[0] if protocol.turning_space == PAIR else 0.0
            known[key] = np.array(correct.activations(distance_m, error_deg, target_deg))
        return known[key]

    def focusing(eyes: Eyes, settings: Any) -> np.ndarray:
        lenses = Lenses(changed(eyes._session.learners.plant, settings).lenses)
        relaxed_d, most_d = (lenses.focus_d(np.full(2, ciliary)) for ciliary in (0.0, 1.0))
        ciliary = (1.0 / eyes._distance_m - relaxed_d) / (most_d - relaxed_d)
        return np.repeat(np.clip(ciliary, 0.0, 1.0), 2)  # sphincters are not commanded

    def looked(eyes: Eyes, n_iterations: int, **how: Any) -> Course:
        space = eyes._session.learners.manager.space
        activations = turning(eyes, how.get("prism", NO_PRISM), how.get("target_deg", AHEAD_DEG))
        if space.has_lenses:
            activations = np.append(activations, focusing(eyes, how.get("settings", {})))
        command[:] = [space.from_all(activations)]
        course = look(eyes, n_iterations, **how)
        seen_deg.append(course.seen_deg[-1])
        return course

    def commanded(agent: Agent, *others: Any, **named: Any) -> Decision:
        return replace(observe(agent, *others, **named), command=command[0])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Eyes, "look", looked)
        patch.setattr(Agent, "observe", commanded)
        yield seen_deg
