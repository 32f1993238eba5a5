"""The protocol of an experiment: which episode comes when (K17 II, Experimental Setup).

An experiment is a sequence of episodes: training episodes, interrupted by whole tests. Each is a
function of (configuration, seed, place in the sequence), so a run goes on wherever it stopped; with
tonic_return also of the activations that the last training episode left, which checkpoints have.
"""

import bisect
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from experiment_manager.config import ExperimentManagerConfig, ProtocolConfig
from experiment_manager.plant_changes import Change, Schedule, read_schedule
from experiment_manager.sections import config_of
from experiment_manager.starts import Activations, Starts, conditions, starts
from eye_plant import Episode
from lockstep import PAIR, InputError, generator
from lockstep.wire.topics import TEST, TRAINING

_N_KEPT = 4


@dataclass(frozen=True)
class Segment:
    """A run of episodes of one kind, with the plant in one stage of its schedule.

    first: place in the sequence; first_observation: of the run; i_test: -1 for training.
    """

    first: int
    n_episodes: int
    first_observation: int
    i_test: int
    training_iteration: int
    stage: int = 0


class Protocol:
    """The sequence of episodes of one experiment."""

    def __init__(
        self,
        config: ProtocolConfig,
        seed: int,
        starts_of_stages: Sequence[Starts],
        schedule: Schedule,
    ) -> None:
        """starts_of_stages: how episodes begin in each stage of the schedule.

        All tests have the same trials, so that they compare: the first stage's conditions.
        """
        self.config = config
        self._schedule = schedule
        self._seed = seed
        self._starts = tuple(starts_of_stages)
        self._follows_changes = config.starts_follow_changes or config.turning_space == PAIR
        self.conditions = conditions(config, self._starts[0].baseline_m)
        self.n_trials = config.n_stimuli_per_test * len(self.conditions)
        self.segments = self._segments()
        self._firsts = [segment.first for segment in self.segments]
        # Drawing an episode takes milliseconds (the inverse of the plant); some ask more than once.
        self._drawn: dict[int, Episode] = {}

    def __len__(self) -> int:
        """Return the number of episodes, test trials included."""
        last = self.segments[-1]
        return last.first + last.n_episodes

    @property
    def test_iterations(self) -> tuple[int, ...]:
        """Training iterations before each test of this experiment."""
        end = self.config.n_training_iterations
        return tuple(sorted({n for n in self.config.test_iterations if n < end} | {end}))

    def _segments(self) -> tuple[Segment, ...]:
        config = self.config
        segments: list[Segment] = []
        first = observation = trained = stage = 0
        # A test comes before the change at its iteration.
        ends = [(at, i_test, -1) for i_test, at in enumerate(self.test_iterations)]
        changes = enumerate(self._schedule.changes, start=1)
        ends += [(change.at, len(ends), stage) for stage, change in changes]
        for at, i_test, next_stage in sorted(ends):
            n_episodes = (at - trained) // config.iterations_per_episode
            if n_episodes:
                segments.append(Segment(first, n_episodes, observation, -1, trained, stage))
                first += n_episodes
                observation += n_episodes * (config.iterations_per_episode + 1)
                trained = at
            if next_stage >= 0:
                stage = next_stage
                continue
            segments.append(Segment(first, self.n_trials, observation, i_test, trained, stage))
            first += self.n_trials
            observation += self.n_trials * (config.iterations_per_trial + 1)
        return tuple(segments)

    def segment(self, place: int) -> Segment:
        """Return the segment that holds an episode; raises IndexError beyond the end."""
        if not 0 <= place < len(self):
            raise IndexError(f"episode {place} of {len(self)}")
        return self.segments[bisect.bisect_right(self._firsts, place) - 1]

    def kind(self, place: int) -> tuple[int, int]:
        """Return phase and number, of the training episode or the trial, without drawing it."""
        segment = self.segment(place)
        offset = place - segment.first
        if segment.i_test >= 0:
            return TEST, offset
        return TRAINING, segment.training_iteration // self.config.iterations_per_episode + offset

    def training_iterations_before(self, place: int) -> int:
        """Return the training iterations that the episodes before a place have made."""
        if place == len(self):
            return self.config.n_training_iterations
        segment = self.segment(place)
        if segment.i_test >= 0:
            return segment.training_iteration
        n_episodes = place - segment.first
        return segment.training_iteration + n_episodes * self.config.iterations_per_episode

    def iterations_before(self, place: int) -> int:
        """Return the iterations, of training and tests, that the episodes before a place make."""
        n_trials = self.trials_from(0) - self.trials_from(place)
        n_of_tests = n_trials * self.config.iterations_per_trial
        return self.training_iterations_before(place) + n_of_tests

    def trials_from(self, place: int) -> int:
        """Return how many test trials there are from a place on."""
        ends = (
            s.first + s.n_episodes - max(s.first, place) for s in self.segments if s.i_test >= 0
        )
        return sum(max(0, n_trials) for n_trials in ends)

    def place_after(self, training_iterations: int) -> int:
        """Return the first place with so many training iterations before it, a test's if one is.

        Raises InputError when no episode begins there.
        """
        per_episode = self.config.iterations_per_episode
        for segment in self.segments:
            done = training_iterations - segment.training_iteration
            if segment.i_test >= 0:
                if done == 0:
                    return segment.first
            elif 0 <= done < segment.n_episodes * per_episode and done % per_episode == 0:
                return segment.first + done // per_episode
        raise InputError(
            f"n_training_iterations: expected {training_iterations} or more, and episodes of which "
            f"one begins there, got {self.config.n_training_iterations}"
        )

    def plant_settings(self, episode: Episode) -> dict[str, Any]:
        """Return the plant's parameters that differ then from those that it was started with."""
        stage = self._schedule.stage(episode.phase, episode.training_iteration)
        return self._schedule.settings(stage)

    def change(self, place: int) -> Change | None:
        """Return the change that comes into force with the episode at a place, if one does."""
        stage = self.segment(place).stage
        before = self.segment(place - 1).stage if place else 0
        return self._schedule.changes[stage - 1] if stage > before else None

    def episode(self, place: int, left: Activations = ()) -> Episode:
        """Return the episode at a place in the sequence; raises IndexError beyond the end.

        left: activations of the commanded muscles at the end of the last training episode, which
        count where episodes begin with them.
        """
        episode = self._drawn.get(place)
        if episode is None:
            episode = self._draw(place, left)
            self._drawn = dict([*self._drawn.items(), (place, episode)][-_N_KEPT:])
        return episode

    def training_episodes(self) -> Iterator[Episode]:
        """Yield the training episodes, one after the other, without the tests between them."""
        for segment in self.segments:
            if segment.i_test < 0:
                yield from map(
                    self.episode, range(segment.first, segment.first + segment.n_episodes)
                )

    def _draw(self, place: int, left: Activations) -> Episode:
        segment = self.segment(place)
        offset = place - segment.first
        if segment.i_test < 0:
            return self._training_episode(segment, offset, left)
        return self._trial(segment, offset)

    def _training_episode(self, segment: Segment, offset: int, left: Activations) -> Episode:
        config = self.config
        number = segment.training_iteration // config.iterations_per_episode + offset
        draw = generator(self._seed, "episode", number)
        stimulus = int(draw.integers(config.n_training_stimuli))
        of_stage = self._starts[segment.stage]
        begins = of_stage if self._follows_changes else self._starts[0]
        object_distance_m, start = begins.training(draw, left)
        return Episode(
            phase=TRAINING,
            test=-1,
            trial=-1,
            episode=number,
            training_iteration=number * config.iterations_per_episode,
            stimulus=stimulus,
            object_distance_m=object_distance_m,
            **{of_stage.argument: start},
            targets_deg=(
                of_stage.targets_deg(start, config.iterations_per_episode, draw)
                if config.gives_targets
                else ()
            ),
            n_iterations=config.iterations_per_episode,
            first_observation=segment.first_observation
            + offset * (config.iterations_per_episode + 1),
        )

    def _trial(self, segment: Segment, trial: int) -> Episode:
        config = self.config
        i_stimulus, i_condition = divmod(trial, len(self.conditions))
        condition = self.conditions[i_condition]
        draw = generator(self._seed, "trial", trial)
        of_stage = self._starts[segment.stage]
        start = of_stage.trial(condition, draw)
        return Episode(
            phase=TEST,
            test=segment.i_test,
            trial=trial,
            episode=segment.training_iteration // config.iterations_per_episode,
            training_iteration=segment.training_iteration,
            stimulus=config.n_training_stimuli + i_stimulus,
            object_distance_m=condition.object_distance_m,
            **{of_stage.argument: start},
            targets_deg=of_stage.targets_deg(start, config.iterations_per_trial, draw),
            n_iterations=config.iterations_per_trial,
            first_observation=segment.first_observation + trial * (config.iterations_per_trial + 1),
        )


def make_protocol(config: ExperimentManagerConfig) -> Protocol:
    """Return the sequence of episodes of a configuration."""
    schedule = read_schedule(config.schedule)
    starts_of_stages = [
        starts(config, plant.mechanics, plant.camera.turns_deg, plant.lenses)
        for plant in schedule.plants(config.plant)
    ]
    return Protocol(config, config.seed, starts_of_stages, schedule)


def protocol_of(configuration: Mapping[str, Mapping[str, Any]]) -> Protocol:
    """Return the sequence of episodes of a run, from its configuration by section."""
    return make_protocol(config_of(ExperimentManagerConfig, configuration))
