"""The published model end to end in one file, from the parts of the packages: K17's Fig. 1.

    .venv/bin/python docs/examples/k17.py --iterations 2000                      # model M
    .venv/bin/python docs/examples/k17.py --iterations 200000 --lambda 0.065     # model M_C

Two eyes look at a plane. Matching pursuit codes both pictures together; what the code leaves
unexplained, and the energy of the muscles, are the (negative) reward. CACLA+VAR learns from it how
to change the activations of medial and lateral recti. This is the profile `paper`, bit for bit.
"""

import argparse
import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from eye_plant import (
    Episode,
    EyePlant,
    EyePlantConfig,
    Inverse,
    Observation,
    StimulusSet,
    desired_vergence_deg,
    load_stimuli,
)
from lockstep import COMMAND_SPACES, generator
from sparse_coder.dictionary import Dictionary, initial_atoms, learned_atoms
from sparse_coder.matching_pursuit import matching_pursuit, mean_squared_coefficients
from sparse_coder.patches import COARSE, FINE, N_PIXELS, binocular_patches, window_of
from sparse_coder.reward import reconstruction_error, reward
from vergence_rl.cacla.actor import (
    ActorOutput,
    ActorWeights,
    actor,
    actor_rate,
    actor_step,
    n_updates,
)
from vergence_rl.cacla.critic import bounded_rate, critic_step, td_error, value
from vergence_rl.learning_rule import td_variance
from vergence_rl.normalizer import empty_statistics, normalized, updated_statistics

Floats = NDArray[np.float64]

# K17 II, or as docs/model/deviations.md numbers them (D5, D11, D13, D14).
N_BASES, N_SELECTIONS, DICTIONARY_RATE = 400, 10, 0.2
STATE_SD, BIAS_INPUT = 0.02, 0.02
DISCOUNT, CRITIC_RATE, CRITIC_STEP_LIMIT = 0.3, 0.75, 1.0
N_HIDDEN, ACTOR_RATE, SHRINKAGE = 50, 0.5, 1e-5
EXPLORATION_VARIANCE, TD_VARIANCE_RATE = 1e-5, 0.001
ITERATIONS_PER_EPISODE, ITERATIONS_PER_TRIAL = 10, 20
DISTANCES_M, TEST_DISTANCES_M = (0.5, 6.0), (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
LEAST_START_ERROR_DEG = -3

RECTI = COMMAND_SPACES["pair"]  # medial and lateral rectus, of both eyes alike
LOWEST, HIGHEST = np.zeros(2), np.array([0.2, 0.1])
N_STATE = 2 * N_BASES + 2 + 1  # features, activations, bias


@dataclass
class Last:
    """What the next iteration of an episode learns from: s, the actor's output, and the action."""

    state: Floats
    output: ActorOutput
    action: Floats


class Learner:
    """Dictionaries, normaliser, critic and actor."""

    def __init__(self, seed: int, n_iterations: int, weight: float) -> None:
        """n_iterations: of training; weight: lambda in 1/W, 0 for model M."""
        self.seed, self.n_iterations, self.weight = seed, n_iterations, weight
        self.dictionaries = [
            Dictionary(initial_atoms(generator(seed, "dictionary", scale), N_BASES, N_PIXELS))
            for scale in (0, 1)  # coarse, fine
        ]
        self.statistics = empty_statistics(N_STATE - 1, 0.0)
        draw = generator(seed, "weights", 0)
        self.critic = draw.uniform(-1.0 / N_STATE, 1.0 / N_STATE, N_STATE)
        width = 1.0 / (N_STATE * N_HIDDEN)
        self.actor = ActorWeights(
            draw.uniform(-width, width, (N_HIDDEN, N_STATE)),
            draw.uniform(-0.01, 0.01, (2, N_HIDDEN)),
        )
        self.td_variance = 1.0
        self.last: Last | None = None

    def step(self, seen: Observation, *, training: bool) -> Floats:
        """Return the command (2,) for an observation; in training learn from it, and explore."""
        # What the eyes see is coded: patches of both eyes, at two scales, each by ten atoms.
        windows = ([window_of(p, s) for p in seen.pictures] for s in (COARSE, FINE))  # type: ignore[union-attr]
        patches = [binocular_patches(*of_both) for of_both in windows]
        codes = [
            matching_pursuit(p, dictionary.atoms, dictionary.gram, N_SELECTIONS)
            for p, dictionary in zip(patches, self.dictionaries, strict=True)
        ]
        features = [mean_squared_coefficients(code, N_BASES) for code in codes]
        # The reward (eq. 2, eq. 5).
        errors = [reconstruction_error(p, code) for p, code in zip(patches, codes, strict=True)]
        rate_w = float(seen.state.metabolic_rate_w[RECTI.indices].sum())
        r_t = reward(-sum(errors), rate_w, self.weight).value
        # The state: features and activations, normalised, and a constant.
        activations = RECTI.from_all(seen.state.activations)
        entries = np.concatenate([*features, activations], dtype=np.float64)
        if training:
            self.statistics = updated_statistics(self.statistics, entries)
        state = np.append(normalized(self.statistics, entries, STATE_SD), BIAS_INPUT)
        # Critic and actor learn from the last action; then the actor acts.
        if training and self.last is not None and seen.iteration > 0:
            self._learn(self.last, state, r_t, seen.training_iteration)
        output = actor(self.actor, state)
        action = output.action
        if training:
            draw = generator(self.seed, "exploration", seen.training_iteration)
            action = action + draw.normal(0.0, math.sqrt(EXPLORATION_VARIANCE), 2)
        command = np.clip(activations + action, LOWEST, HIGHEST)
        self.last = Last(state, output, command - activations) if training else None
        # The dictionaries learn to code what was seen.
        if training:
            for dictionary, p, code in zip(self.dictionaries, patches, codes, strict=True):
                dictionary.replace(learned_atoms(dictionary.atoms, p, code, DICTIONARY_RATE))
        return command

    def _learn(self, last: Last, state: Floats, r_t: float, training_iteration: int) -> None:
        """Update the critic by the TD error (eq. 3), the actor if that is above 0 (eq. 4)."""
        delta = td_error(r_t, DISCOUNT, value(self.critic, state), value(self.critic, last.state))
        alpha = bounded_rate(CRITIC_RATE, last.state, CRITIC_STEP_LIMIT)
        self.critic = critic_step(self.critic, last.state, delta, alpha)
        self.td_variance = td_variance(self.td_variance, delta, TD_VARIANCE_RATE)
        n = n_updates(delta, self.td_variance)
        if n > 0:
            beta = actor_rate(ACTOR_RATE, training_iteration, self.n_iterations)
            self.actor = actor_step(
                self.actor,
                last.state,
                last.output,
                last.action,
                rate=beta * n,
                shrinkage=beta * SHRINKAGE,
            )


class Experiment:
    """Training episodes and the trials of a test, as functions of the seed."""

    def __init__(self, seed: int, config: EyePlantConfig, stimuli: StimulusSet) -> None:
        """stimuli: those of the plant, for training and for tests."""
        self.seed, self.stimuli = seed, stimuli
        self._inverse = Inverse(config.mechanics)
        self._baseline_m = config.mechanics.baseline_m

    def training_episode(self, number: int) -> Episode:
        """Return ten iterations with one picture, at another distance than the eyes look at."""
        draw = generator(self.seed, "episode", number)
        stimulus = int(draw.integers(len(self.stimuli.training)))
        object_m, fixation_m = float(draw.uniform(*DISTANCES_M)), float(draw.uniform(*DISTANCES_M))
        return Episode(
            phase=0,
            test=-1,
            trial=-1,
            episode=number,
            training_iteration=ITERATIONS_PER_EPISODE * number,
            stimulus=stimulus,
            object_distance_m=object_m,
            activations=self._activations(self._desired_deg(fixation_m), draw),
            n_iterations=ITERATIONS_PER_EPISODE,
            first_observation=(ITERATIONS_PER_EPISODE + 1) * number,
        )

    def trials(self, n_stimuli: int) -> Iterator[Episode]:
        """Yield the trials of a test: pictures x distances x start errors in whole degrees."""
        conditions = [
            (distance_m, error_deg)
            for distance_m in TEST_DISTANCES_M
            for error_deg in range(
                LEAST_START_ERROR_DEG, math.floor(self._desired_deg(distance_m)) + 1
            )
        ]
        for trial in range(n_stimuli * len(conditions)):
            i_stimulus, i_condition = divmod(trial, len(conditions))
            distance_m, error_deg = conditions[i_condition]
            vergence_deg = self._desired_deg(distance_m) - error_deg
            draw = generator(self.seed, "trial", trial)
            yield Episode.alone(
                len(self.stimuli.training) + i_stimulus,
                distance_m,
                self._activations(vergence_deg, draw),
                ITERATIONS_PER_TRIAL,
            )

    def _desired_deg(self, distance_m: float) -> float:
        return desired_vergence_deg(distance_m, self._baseline_m)

    def _activations(self, vergence_deg: float, draw: np.random.Generator) -> tuple[float, ...]:
        """Draw one of the pairs of activations that give a vergence; the others are tonic."""
        limits = tuple(zip(LOWEST.tolist(), HIGHEST.tolist(), strict=True))
        return self._inverse.activations(vergence_deg, float(draw.random()), limits)


def run_episode(
    plant: EyePlant, learner: Learner, episode: Episode, *, training: bool
) -> Observation:
    """Look, decide, move the eyes, look again; return what comes of the last command."""
    seen = plant.begin(episode)
    while seen.pictures is not None:
        command = learner.step(seen, training=training)
        seen = plant.execute(plant.targets(RECTI.names, command))
    return seen


def train(plant: EyePlant, learner: Learner, experiment: Experiment) -> None:
    """Run all training episodes."""
    for number in range(learner.n_iterations // ITERATIONS_PER_EPISODE):
        run_episode(plant, learner, experiment.training_episode(number), training=True)


def tested_errors_deg(
    plant: EyePlant, learner: Learner, experiment: Experiment, n_stimuli: int
) -> Floats:
    """Return |vergence error| at the end of each trial of a test, (n_trials,)."""
    ends = (
        run_episode(plant, learner, trial, training=False) for trial in experiment.trials(n_stimuli)
    )
    return np.array([abs(end.truth.vergence_error_deg) for end in ends])


def main() -> None:
    """Train, test, and print how precisely the eyes verge."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--iterations", type=int, default=1_000_000)
    parser.add_argument("--lambda", dest="weight", type=float, default=0.0, help="1/W; 0: model M")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    config = EyePlantConfig()
    stimuli = load_stimuli(config.stimuli)
    plant = EyePlant(config, stimuli)
    learner = Learner(arguments.seed, arguments.iterations, arguments.weight)
    experiment = Experiment(arguments.seed, config, stimuli)
    train(plant, learner, experiment)
    errors_deg = tested_errors_deg(plant, learner, experiment, n_stimuli=1)
    print(f"median |vergence error| of {len(errors_deg)} trials: {np.median(errors_deg):.3f} deg")


if __name__ == "__main__":
    main()
