"""The whole loop in one process, without ROS: the oracle of the graph, and its yardstick."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.configuration import build
from lockstep.errors import InputError
from lockstep.state_file import read_state, write_state
from lockstep.wire.topics import COMMAND_NAMES, HORIZONTAL_RECTI, TRAINING
from sparse_coder.coder import Encoding, SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.reward import reward
from vergence_rl.agent import Agent, Decision
from vergence_rl.config import VergenceRlConfig


@dataclass(frozen=True)
class Answer:
    """What the learners made of one observation.

    features: (2, n_bases) float32; reconstruction_error: (2,) coarse, fine; coder_learning_steps,
    agent_learning_steps: as each counts them in its answer.
    """

    features: np.ndarray
    reconstruction_error: np.ndarray
    metabolic_rate_w: float
    reward: float
    decision: Decision
    coder_learning_steps: int
    agent_learning_steps: int


@dataclass(frozen=True)
class Step:
    """An observation and its answer; the last observation of an episode has none."""

    observation: Observation
    answer: Answer | None


@dataclass(frozen=True)
class Percept:
    """What the sparse coder makes of one observation, and what it is worth.

    activations: (2,) of medial and lateral rectus, the mean of both eyes.
    """

    encoding: Encoding
    metabolic_rate_w: float
    reward: float
    activations: np.ndarray


class Perception:
    """The sparse coder before the plant: all that an agent gets to know."""

    def __init__(self, plant: EyePlant, coder: SparseCoder, metabolic_cost_weight: float) -> None:
        """metabolic_cost_weight: lambda of K17 eq. 5, 1/W."""
        self._coder = coder
        self._weight = metabolic_cost_weight
        names = plant.oculomotor.muscle_names
        self._recti = [names.index(name) for name in HORIZONTAL_RECTI]

    def perceive(self, observation: Observation, *, learning: bool) -> Percept:
        """Encode an observation with pictures; learning: the dictionaries move afterwards."""
        assert observation.pictures is not None
        encoding = self._coder.encode(*observation.pictures)
        state = observation.state
        metabolic_rate_w = float(state.metabolic_rate_w[self._recti].sum())
        reward_t = reward(encoding.reconstruction_error, metabolic_rate_w, self._weight)
        if learning:
            self._coder.learn(encoding)
        activations = state.activations[self._recti].reshape(2, 2).mean(axis=0)
        return Percept(encoding, metabolic_rate_w, reward_t, activations)


class InProcessLoop:
    """Plant, coder and agent, called in the order in which the graph's messages call them."""

    def __init__(
        self, plant: EyePlant, coder: SparseCoder, agent: Agent, metabolic_cost_weight: float
    ) -> None:
        """metabolic_cost_weight: lambda of K17 eq. 5, 1/W."""
        self.plant = plant
        self.coder = coder
        self.agent = agent
        self._perception = Perception(plant, coder, metabolic_cost_weight)

    @property
    def learners(self) -> dict[str, SparseCoder | Agent]:
        """The learners by the names of their nodes."""
        return {"sparse_coder": self.coder, "vergence_rl": self.agent}

    def save(self, paths: Mapping[str, Path]) -> None:
        """Write each learner's state; raises InputError when a place cannot be written."""
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
        in_training = episode.phase == TRAINING
        observation = self.plant.begin(episode)
        while observation.pictures is not None:
            answer = self._answer(observation, learning and in_training, in_training)
            yield Step(observation, answer)
            observation = self.plant.execute(
                self.plant.targets(COMMAND_NAMES, answer.decision.command)
            )
        yield Step(observation, None)

    def _answer(self, observation: Observation, learning: bool, exploration: bool) -> Answer:
        coder_learning_steps = self.coder.learning_steps
        percept = self._perception.perceive(observation, learning=learning)
        decision = self.agent.observe(
            percept.encoding.features,
            percept.activations,
            percept.reward,
            observation.iteration,
            observation.training_iteration,
            learning=learning,
            exploration=exploration,
        )
        return Answer(
            percept.encoding.features,
            percept.encoding.reconstruction_error,
            percept.metabolic_rate_w,
            percept.reward,
            decision,
            coder_learning_steps,
            self.agent.learning_steps,
        )


def make_loop(
    parameters: Mapping[str, Mapping[str, Any]], stimuli: StimulusSet | None = None
) -> InProcessLoop:
    """Return the loop of a run, untrained, from all parameters by node.

    stimuli: instead of those that the plant's parameters ask for. Raises InputError for whatever a
    node would refuse.
    """
    coder = build(SparseCoderConfig, parameters["sparse_coder"])
    return InProcessLoop(
        EyePlant(build(EyePlantConfig, parameters["eye_plant"]), stimuli),
        SparseCoder(coder),
        Agent(build(VergenceRlConfig, parameters["vergence_rl"])),
        coder.metabolic_cost_weight,
    )
