"""The same loop in one process, with a stopwatch at each stage."""

import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from experiment_manager import protocol_of
from experiment_manager.loop import Step, make_loop
from experiment_manager.run.config_file import Configuration
from eye_plant import Observation

STAGES = ("physics", "rendering", "encoding", "dictionary_step", "actor_critic", "episode_start")
# The parts of physics: each call of an iteration.
_OCULOMOTOR = "oculomotor"


@dataclass(frozen=True)
class LoopWindow:
    """iterations per second, and the mean duration of each stage's calls, by stage."""

    rate_hz: float
    stages_ms: dict[str, float]


class TimedLoop:
    """Training episodes in this process, as the configuration's protocol gives them."""

    def __init__(self, configuration: Configuration) -> None:
        """Set up plant, coder and agent, and attach the stopwatches."""
        self._loop = make_loop(configuration)
        self.plant, self.coder = self._loop.plant, self._loop.coder
        self._episodes = protocol_of(configuration).training_episodes()
        self._durations_s: dict[str, list[float]] = defaultdict(list)
        self.pictures: list[np.ndarray] = []
        oculomotor = self.plant.oculomotor
        for owner, name, stage in (
            (oculomotor, "step", _OCULOMOTOR),
            (oculomotor, "state", _OCULOMOTOR),
            (self.coder, "encode", "encoding"),
            (self.coder, "learn", "dictionary_step"),
            (self._loop.agent, "observe", "actor_critic"),
            (self.plant, "begin", "episode_start"),
        ):
            setattr(owner, name, self._timed(getattr(owner, name), stage))
        self._execute = self.plant.execute
        setattr(self.plant, "execute", self._timed_execute)  # noqa: B010 (mypy: methods are fixed)

    def _timed(self, function: Callable[..., Any], stage: str) -> Callable[..., Any]:
        def call(*arguments: Any, **named: Any) -> Any:
            start_s = time.perf_counter()
            result = function(*arguments, **named)
            self._durations_s[stage].append(time.perf_counter() - start_s)
            return result

        return call

    def _timed_execute(self, activations: np.ndarray) -> Observation:
        """Move and draw; what is not physics is rendering, if anything was drawn."""
        self._durations_s[_OCULOMOTOR].clear()
        start_s = time.perf_counter()
        observation = self._execute(activations)
        whole_s = time.perf_counter() - start_s
        physics_s = sum(self._durations_s[_OCULOMOTOR])
        self._durations_s["physics"].append(physics_s)
        if observation.pictures is not None:
            self._durations_s["rendering"].append(whole_s - physics_s)
        return observation

    def window(self, duration_s: float) -> LoopWindow:
        """Run whole training episodes for at least so long."""
        self._durations_s.clear()
        start_s, n_iterations = time.perf_counter(), 0
        while (elapsed_s := time.perf_counter() - start_s) < duration_s:
            steps: list[Step] = list(self._loop.run_episode(next(self._episodes)))
            n_iterations += len(steps) - 1
            pictures = steps[0].observation.pictures
            assert pictures is not None
            self.pictures = [*self.pictures[-15:], pictures]
        means_ms = {name: 1e3 * float(np.mean(self._durations_s[name])) for name in STAGES}
        return LoopWindow(n_iterations / elapsed_s, means_ms)

    def encode_pair_ms(self, n_times: int) -> float:
        """Return the median time from a pair of the last pictures to its features."""
        durations_s = []
        for i in range(n_times):
            pair = self.pictures[i % len(self.pictures)]
            start_s = time.perf_counter()
            self.coder.encode(*pair)
            durations_s.append(time.perf_counter() - start_s)
        return 1e3 * float(np.median(durations_s))

    def close(self) -> None:
        """Release the camera."""
        self.plant.close()
