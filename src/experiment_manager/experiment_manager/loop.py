"""The whole loop in one process, without ROS: the oracle of the graph, and its yardstick."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np

from experiment_manager.sections import config_of
from eye_plant import Episode, EyePlant, EyePlantConfig, Head, Observation, StimulusSet
from eye_plant.head.plant import HeadPlant
from lockstep import InputError, read_state, write_state
from lockstep.wire.topics import TRAINING
from sparse_coder import Percept, SparseCoder, SparseCoderConfig
from sparse_coder.camera import central_view
from sparse_coder.percept import NO_GAZE
from vergence_rl import Agent, Decision, VergenceRlConfig


@dataclass(frozen=True)
class Answer:
    """What the learners made of one observation.

    agent_learning_steps: as the agent counts them in its answer.
    """

    percept: Percept
    decision: Decision
    agent_learning_steps: int


@dataclass(frozen=True)
class Step:
    """An observation and its answer; the last observation of an episode has none."""

    observation: Observation
    answer: Answer | None


class InProcessLoop:
    """Plant, coder and agent, called in the order in which the graph's messages call them.

    Example:
        >>> import numpy as np
        >>> from experiment_manager.loop import make_loop
        >>> from eye_plant import Episode, StimulusSet
        >>> noise = np.random.default_rng(0).integers(0, 256, (2, 64, 64), np.uint8)
        >>> loop = make_loop({}, StimulusSet((noise[0],), (noise[1],)))
        >>> episode = Episode.alone(0, 1.0, [0.05] * 12, n_iterations=2)
        >>> steps = list(loop.run_episode(episode))
        >>> [step.answer is not None for step in steps]
        [True, True, False]
        >>> loop.plant.close()
    """

    def __init__(self, plant: EyePlant, coder: SparseCoder, agent: Agent) -> None:
        """All three must have the same command space; a head's plant does as `EyePlant` here."""
        self.plant = plant
        self.coder = coder
        self.agent = agent
        self._space = agent.config.space

    @property
    def learners(self) -> dict[str, SparseCoder | Agent]:
        """The learners by the names of their nodes."""
        return {"sparse_coder": self.coder, "vergence_rl": self.agent}

    def save(self, paths: Mapping[str, Path]) -> None:
        """Write each learner's state; raises OSError when the disk refuses."""
        for name, path in paths.items():
            write_state(path, name, self.learners[name].state())

    def restore(self, paths: Mapping[str, Path]) -> None:
        """Take over each learner's state; raises InputError for a file that holds none that fits.

        What was taken over before that stays.
        """
        for name, path in paths.items():
            try:
                self.learners[name].restore(read_state(path, name))
            except ValueError as error:
                raise InputError(f"{path}: {error}") from error

    def run_episode(self, episode: Episode, *, learning: bool = True) -> Iterator[Step]:
        """Yield the steps of an episode; learners learn in training episodes only."""
        explores = episode.phase == TRAINING
        learns = learning and explores
        seen = self.plant.begin(episode)
        while seen.pictures is not None:
            percept = self._perceive(seen)
            decision = self._decide(seen, percept, learning=learns, exploration=explores)
            if learns:
                self.coder.learn(percept.encoding)
            yield Step(seen, Answer(percept, decision, self.agent.learning_steps))
            seen = self.plant.execute(self.plant.targets(self._space.names, decision.command))
        yield Step(seen, None)

    def _perceive(self, seen: Observation) -> Percept:
        """Return features and reward of an observation with pictures."""
        assert seen.pictures is not None
        left, right = seen.pictures
        if seen.cameras is not None:
            focal_px = self.coder.config.camera.focal_length_px
            left = central_view(left, seen.cameras[0], focal_px)
            right = central_view(right, seen.cameras[1], focal_px)
        rates_w = seen.rates_w(self._space)
        given_deg = np.reshape(seen.given_target_deg, (2, 2))
        return self.coder.perceive(
            left, right, rates_w, apart=seen.apart, moment=seen.moment, given_deg=given_deg
        )

    def _decide(
        self,
        seen: Observation,
        percept: Percept,
        *,
        learning: bool,
        exploration: bool,
    ) -> Decision:
        """Return the command that follows from it, having learned from the last one."""
        gaze = percept.gaze or NO_GAZE
        return self.agent.observe(
            percept.encoding.features,
            self._space.from_all(seen.felt),
            percept.reward,
            seen.iteration,
            seen.training_iteration,
            learning=learning,
            exploration=exploration,
            target_deg=gaze.target_deg,
            turns_deg=gaze.turns_deg,
            leading_eye=gaze.leading_eye,
            energy_penalty=percept.energy_penalty,
        )


def make_loop(
    configuration: Mapping[str, Mapping[str, Any]],
    stimuli: StimulusSet | None = None,
    head: Head | None = None,
) -> InProcessLoop:
    """Return the loop of a run, untrained, from its configuration by section.

    stimuli: instead of those that the plant's parameters ask for; head: instead of the eyes. Raises
    InputError for whatever a node would refuse.
    """
    plant = config_of(EyePlantConfig, configuration)
    return InProcessLoop(
        EyePlant(plant, stimuli) if head is None else cast(EyePlant, HeadPlant(head, plant)),
        SparseCoder(config_of(SparseCoderConfig, configuration)),
        Agent(config_of(VergenceRlConfig, configuration)),
    )
