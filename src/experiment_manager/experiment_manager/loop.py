"""The whole loop in one process, without ROS: the oracle of the graph, and its yardstick."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from eye_plant.config import EyePlantConfig
from eye_plant.episode import Episode
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from eye_plant.stimuli.stimulus_set import StimulusSet
from lockstep.configuration import build
from lockstep.topics import COMMAND_NAMES, HORIZONTAL_RECTI, TRAINING
from sparse_coder.coder import SparseCoder
from sparse_coder.config import SparseCoderConfig
from sparse_coder.reward import reward
from vergence_rl.agent import Agent, Decision
from vergence_rl.config import VergenceRlConfig


@dataclass(frozen=True)
class Answer:
    """What the learners made of one observation.

    reconstruction_error: (2,) coarse, fine; features: (2, n_bases).
    """

    features: np.ndarray
    reconstruction_error: np.ndarray
    metabolic_rate_w: float
    reward: float
    decision: Decision


@dataclass(frozen=True)
class Step:
    """An observation and its answer; the last observation of an episode has none."""

    observation: Observation
    answer: Answer | None


class InProcessLoop:
    """Plant, coder and agent, called in the order in which the graph's messages call them."""

    def __init__(
        self, plant: EyePlant, coder: SparseCoder, agent: Agent, metabolic_cost_weight: float
    ) -> None:
        """metabolic_cost_weight: lambda of K17 eq. 5, 1/W."""
        self.plant = plant
        self.coder = coder
        self.agent = agent
        self._weight = metabolic_cost_weight
        names = plant.oculomotor.muscle_names
        self._recti = [names.index(name) for name in HORIZONTAL_RECTI]

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
        assert observation.pictures is not None
        encoding = self.coder.encode(*observation.pictures)
        metabolic_rate_w = float(observation.state.metabolic_rate_w[self._recti].sum())
        reward_t = reward(encoding.reconstruction_error, metabolic_rate_w, self._weight)
        if learning:
            self.coder.learn(encoding)
        activations = observation.state.activations[self._recti].reshape(2, 2).mean(axis=0)
        decision = self.agent.observe(
            encoding.features,
            activations,
            reward_t,
            observation.iteration,
            observation.training_iteration,
            learning=learning,
            exploration=exploration,
        )
        return Answer(
            encoding.features, encoding.reconstruction_error, metabolic_rate_w, reward_t, decision
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
