"""When all messages that an episode must bring have been recorded. No ROS."""

from collections.abc import Sequence

from experiment_manager.run.recorded_topics import SMALL_TOPICS
from eye_plant import Episode
from lockstep.wire.topics import HEAD_VECTORS, PLANT_VECTORS, TRAINING

_OF_PLANTS = frozenset((*PLANT_VECTORS, *HEAD_VECTORS))


class EpisodeRecord:
    """Counts the small messages of one episode until each expected one is in the bag."""

    def __init__(
        self, episode: Episode, period_ns: int, topics: Sequence[str] = SMALL_TOPICS
    ) -> None:
        """period_ns: between the stamps of successive observations; topics: of small messages."""
        self.episode = episode
        self._period_ns = period_ns
        self.first_ns = episode.first_observation * period_ns
        self.last_ns = (episode.first_observation + episode.n_iterations) * period_ns
        n_answers = episode.n_iterations
        self._missing = {
            topic: n_answers + 1 if topic in _OF_PLANTS else n_answers for topic in topics
        }

    def holds(self, stamp_ns: int) -> bool:
        """Return whether an observation with that stamp belongs to the episode."""
        return self.first_ns <= stamp_ns <= self.last_ns and not stamp_ns % self._period_ns

    def iteration(self, stamp_ns: int) -> int:
        """Return the iteration within the episode that has the stamp."""
        return (stamp_ns - self.first_ns) // self._period_ns

    def expects(self, topic: str, stamp_ns: int) -> bool:
        """Return whether a message of a small topic with a stamp of the episode belongs to it.

        Nobody is to answer its last observation.
        """
        return topic in _OF_PLANTS or stamp_ns != self.last_ns

    def count(self, topic: str) -> None:
        """Count an expected message that was recorded for the first time."""
        self._missing[topic] -= 1

    @property
    def is_complete(self) -> bool:
        """Whether each expected message has been recorded."""
        return not any(self._missing.values())

    def missing(self) -> str:
        """Return what has not come yet, for an error text."""
        return ", ".join(f"{count} of {name}" for name, count in self._missing.items() if count)


class TimedRecord(EpisodeRecord):
    """The record of an episode whose stamps are those of a clock: the topic episode numbers them.

    first_ns, last_ns: those of its first and last observation, -1 until they have come.
    """

    def __init__(self, episode: Episode, topics: Sequence[str]) -> None:
        """topics: of small messages."""
        super().__init__(episode, 1, topics)
        self.first_ns = self.last_ns = -1
        self._iterations: dict[int, int] = {}

    def note(self, stamp_ns: int, observation: int) -> bool:
        """Take the stamp for that of an observation, by its number; return whether it is ours."""
        iteration = observation - self.episode.first_observation
        if not 0 <= iteration <= self.episode.n_iterations:
            return False
        self._iterations.setdefault(stamp_ns, iteration)
        self.first_ns = next(iter(self._iterations))
        if iteration == self.episode.n_iterations:
            self.last_ns = stamp_ns
        return True

    def holds(self, stamp_ns: int) -> bool:
        """Return whether an observation with that stamp belongs to the episode."""
        return stamp_ns in self._iterations

    def iteration(self, stamp_ns: int) -> int:
        """Return the iteration within the episode that has the stamp."""
        return self._iterations[stamp_ns]


def learning_steps(topic: str, episode: Episode, iteration: int) -> int:
    """Return the learning steps that a learner must count in its answer, K17's protocol kept.

    The sparse coder (`reward`) learns once per training iteration, after it has answered; the
    actor-critic (`actor_critic`) once per training iteration but the first of each episode, before.
    """
    in_episode = iteration if episode.phase == TRAINING else 0
    n_episodes = episode.episode if topic == "actor_critic" else 0
    return episode.training_iteration - n_episodes + in_episode
