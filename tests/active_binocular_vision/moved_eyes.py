"""Eyes that move although they have not learned to."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from vergence_rl import Agent, Decision


@contextmanager
def moved_eyes(
    change: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> Iterator[pytest.MonkeyPatch]:
    """Let agents change activations (12,) by what they see: features and the target in deg (2,)."""
    observe = Agent.observe

    def moved(
        agent: Agent, features: Any, activations: Any, *others: Any, **named: Any
    ) -> Decision:
        decision = observe(agent, features, activations, *others, **named)
        command = activations + change(features, named.get("target_deg", np.full(2, np.nan)))
        return replace(decision, command=np.clip(command, 0.0, 0.2))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Agent, "observe", moved)
        yield patch
