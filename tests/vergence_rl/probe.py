"""A problem that every rule learns: a cue says how far the eyes are to converge."""

import numpy as np

from vergence_rl import Agent

# A state large enough to learn in a few thousand iterations.
SETTINGS = {
    "n_bases": 1,
    "n_training_iterations": 20_000,
    "state_standard_deviation": 0.5,
    "bias_input": 0.5,
    "initial_td_variance": 1e-3,
    "td_variance_rate": 0.01,
}

_HIGHEST = np.array([0.2, 0.1])
_GAZES = (-0.04, 0.0, 0.04, 0.08)


def trained_on_gazes(agent: Agent, n_episodes: int, price: float = 0.0) -> None:
    """Reward the gaze, medial - lateral activation, that a cue asks for; activation has a price."""
    draw, length = np.random.default_rng(1), agent.config.iterations_per_episode
    for episode in range(n_episodes):
        gaze, place = draw.uniform(-0.05, 0.1), draw.uniform(0.0, _HIGHEST)
        for i in range(length):
            reward = -abs(place[0] - place[1] - gaze) - price * float(place.sum())
            place = agent.observe(
                *(np.array([gaze, 1.0]), place, reward, i, length * episode + i),
                learning=True,
                exploration=True,
            ).command


def gaze_errors(agent: Agent) -> tuple[np.ndarray, np.ndarray]:
    """Return errors (n_gazes,) after 20 iterations from the middle, and places (n_gazes, 2)."""
    ends = []
    for gaze in _GAZES:
        place = np.array([0.1, 0.05])
        for i in range(20):
            place = agent.observe(
                *(np.array([gaze, 1.0]), place, 0.0, i, 0), learning=False, exploration=False
            ).command
        ends.append(place)
    places = np.array(ends)
    return np.abs(places[:, 0] - places[:, 1] - _GAZES), places
