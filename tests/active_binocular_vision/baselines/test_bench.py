"""Sensors, eyes and tasks together, on runs that were hardly trained."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from active_binocular_vision import Run
from active_binocular_vision.baselines import deep_rl
from active_binocular_vision.baselines.bench import Bench, Controller, errors_deg
from active_binocular_vision.baselines.read_out import known_places
from active_binocular_vision.baselines.turning import MotorMap, steering
from experiment_manager import summary_of
from experiment_manager.measures.criteria import criteria_of
from lockstep import InputError, read_state


@pytest.fixture
def bench(run_of: Callable[[str], Path]) -> Iterator[Callable[[str], Bench]]:
    with ExitStack() as benches:

        def opened(kind: str) -> Bench:
            run = Run(run_of(kind))
            assert run.states is not None
            state = read_state(run.states / "sparse_coder.npz", "sparse_coder")
            return benches.enter_context(closing(Bench(run, state)))

        yield opened


@pytest.mark.parametrize(("kind", "n_axes"), [("pair", 1), ("twelve", 3)])
def test_a_perfect_sensor_brings_the_eyes_to_rest_in_a_few_commands(bench, kind, n_axes):
    eyes = bench(kind)
    now: list[np.ndarray] = []
    motor = MotorMap(eyes.manager, eyes.plant.config)
    controller = steering(lambda _: now[-1], motor)
    episode = next(eyes.protocol.training_episodes())
    for seen in eyes.observations(controller, episode):
        now.append(errors_deg(seen))
    assert np.abs(now[0][:n_axes]).max() > 0.1
    assert np.abs(now[-1][:n_axes]).max() < 1e-3


def test_trials_are_those_of_the_runs_own_test(bench, run_of):
    eyes, run = bench("pair"), Run(run_of("pair"))
    trials = eyes.trials(lambda seen: eyes.manager.space.from_all(seen.activations))
    own = run.summaries[-1]
    assert summary_of(trials, criteria_of(eyes.plant.config)).n_trials == own.n_trials
    assert trials.training_iteration == own.iteration
    # Nothing moved.
    np.testing.assert_allclose(
        trials.vergence_error_deg, trials.vergence_error_deg[:, :1] + np.zeros(21), atol=1e-9
    )
    assert len(eyes.trials(lambda seen: np.zeros(2), 7).trial) == -(-own.n_trials // 7)


def test_known_places_have_errors_of_all_sizes(bench):
    eyes = bench("twelve")
    places = known_places(eyes, MotorMap(eyes.manager, eyes.plant.config))
    seen = [(given.iteration, error) for (given, error), _ in zip(places, range(40), strict=False)]
    assert [iteration for iteration, _ in seen] == [*range(10)] * 4
    errors = np.abs([error for _, error in seen])
    assert (errors.max(axis=0) > 0.5).all()
    assert (errors.min(axis=0) < 0.05).all()


class Follower:
    """An agent of a package that is not there: it steps with one action, which it always takes."""

    def __init__(self, policy, environment, seed):
        assert policy == "MlpPolicy"
        self.num_timesteps, self.environment = 0, environment
        self.observed, _ = environment.reset(seed=seed)

    def learn(self, total_timesteps, reset_num_timesteps):
        assert reset_num_timesteps == (self.num_timesteps == 0)
        for _ in range(total_timesteps):
            action, _ = self.predict(self.observed, deterministic=True)
            self.observed, *_, is_over, _ = self.environment.step(action)
            self.num_timesteps += 1
            if is_over:
                self.observed, _ = self.environment.reset()

    def predict(self, observed, deterministic):
        assert deterministic
        assert self.environment.observation_space.contains(observed)
        return np.array([1.0, 0.0]), None


def test_agents_of_another_package_act_in_the_test_as_in_training(bench, monkeypatch):
    package = SimpleNamespace(Follower=Follower, set_num_threads=lambda n: None)
    monkeypatch.setattr(deep_rl, "extra", lambda name: package)
    eyes = bench("pair")
    tested: list[tuple[int, float]] = []

    def scored(n_steps: int, controller: Controller) -> None:
        first, then, *_ = eyes.observations(controller, eyes.protocol.episode(0))
        change = then.state.activations - first.state.activations
        tested.append((n_steps, eyes.manager.space.from_all(change)[0]))

    deep_rl.train(eyes, "Follower", 12, scored)
    assert [n for n, _ in tested] == [2, 4, 7, 9, 12]
    assert [change for _, change in tested] == pytest.approx([1 / 128] * 5)


@pytest.mark.parametrize("kind", ["gaze", "triad"])
def test_eyes_that_make_saccades_or_focus_have_another_test(run_of, kind):
    with pytest.raises(InputError, match="expected a run without saccades and lenses"):
        Bench(Run(run_of(kind)), {})
