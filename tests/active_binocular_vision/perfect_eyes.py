"""Eyes that hold the right posture, whatever they are shown."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from active_binocular_vision.learners.correct_gaze import AHEAD_DEG, CorrectGaze
from active_binocular_vision.learners.session import NO_PRISM, Course, Eyes
from vergence_rl import Agent, Decision


@contextmanager
def perfect_eyes() -> Iterator[list[np.ndarray]]:
    """Yield the errors (3,) that the pictures have at the end of each look, of eyes so commanded.

    Their activations are those of CorrectGaze at once, for the cameras that a prism has turned and
    for the target.
    """
    observe, look = Agent.observe, Eyes.look
    command: list[np.ndarray] = []
    seen_deg: list[np.ndarray] = []
    known: dict[Any, np.ndarray] = {}

    def wanted(eyes: Eyes, prism: Any, target_deg: Any) -> np.ndarray:
        session, distance_m = eyes._session, eyes._distance_m
        learners, parallax_m = session.learners, session.parallax_m(eyes._i_picture)
        left_deg, right_deg = learners.plant.camera.turns_deg
        turned_deg = tuple(a + b for a, b in zip(right_deg, vars(prism).values(), strict=True))
        key = (learners.run, left_deg, turned_deg, parallax_m, distance_m, tuple(target_deg))
        if key not in known:
            protocol, mechanics = learners.manager, learners.plant.mechanics
            correct = CorrectGaze(protocol, mechanics, (left_deg, turned_deg), parallax_m)
            known[key] = np.array(correct.activations(distance_m, target_deg=target_deg))
        return known[key]

    def looked(eyes: Eyes, n_iterations: int, **how: Any) -> Course:
        prism, target_deg = how.get("prism", NO_PRISM), how.get("target_deg", AHEAD_DEG)
        command[:] = [wanted(eyes, prism, target_deg)]
        course = look(eyes, n_iterations, **how)
        seen_deg.append(course.seen_deg[-1])
        return course

    def commanded(agent: Agent, *others: Any, **named: Any) -> Decision:
        return replace(observe(agent, *others, **named), command=command[0])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Eyes, "look", looked)
        patch.setattr(Agent, "observe", commanded)
        yield seen_deg
