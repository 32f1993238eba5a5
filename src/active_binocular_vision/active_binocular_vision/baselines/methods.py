"""The methods, by name: each is tested on a run's bench, once or as it learns."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from types import MappingProxyType

import numpy as np

from active_binocular_vision.baselines import energy_model
from active_binocular_vision.baselines.bench import Array, Bench, Controller, Seen
from active_binocular_vision.baselines.command_search import CommandSearch, best_so_far
from active_binocular_vision.baselines.deep_rl import train
from active_binocular_vision.baselines.read_out import Entries, calibrated_sensor
from active_binocular_vision.baselines.registration import registered_deg
from active_binocular_vision.baselines.turning import MotorMap, steering
from experiment_manager import Trials
from lockstep import PAIR

# Of a search in one scene: a trial has 20 looks.
SHOWN_LOOKS = (20, 60, 200)


@dataclass(frozen=True)
class Tested:
    """A test of a method.

    iteration: of training, or places of calibration, before it; after: looks, where a search goes
    on for longer than a trial; trials: what the eyes did.
    """

    iteration: int
    trials: Trials
    after: int = 0


@dataclass(frozen=True)
class Effort:
    """One of `every` trials is made; n_steps: of training, and places to calibrate."""

    every: int
    n_steps: int


# Called with each test of a method, as soon as it is made.
Done = Callable[[Tested], None]
Method = Callable[[Bench, Effort, Done], None]


def _registration(bench: Bench, effort: Effort, done: Done) -> None:
    focal_px = bench.plant.config.camera.focal_length_px
    motor = MotorMap(bench.manager, bench.plant.config)

    def sensor(seen: Seen) -> Array:
        left, right = seen.pictures
        return np.nan_to_num(registered_deg(left, right, focal_px))

    done(Tested(0, bench.trials(steering(sensor, motor), effort.every)))


def _read_out(
    bench: Bench, effort: Effort, done: Done, *, entries: Entries, n_axes: int, places_share: float
) -> None:
    motor = MotorMap(bench.manager, bench.plant.config)
    n_axes = 1 if bench.manager.turning_space == PAIR else n_axes
    n_places = round(places_share * effort.n_steps)
    sensor = calibrated_sensor(bench, motor, entries, n_axes, n_places)
    done(Tested(n_places, bench.trials(steering(sensor, motor), effort.every)))


def _cma_es(bench: Bench, effort: Effort, done: Done) -> None:
    search = CommandSearch(bench.manager.space, bench.manager.limits, bench.manager.seed)
    trials = bench.trials(search, effort.every, SHOWN_LOOKS[-1] + 1)
    costs = np.array(search.costs)
    for n_looks in SHOWN_LOOKS:
        done(Tested(0, best_so_far(trials, costs[:, : n_looks + 1]), n_looks))


def _stable_baselines(bench: Bench, effort: Effort, done: Done, algorithm: str) -> None:
    def score(n_steps: int, controller: Controller) -> None:
        done(Tested(n_steps, bench.trials(controller, effort.every)))

    train(bench, algorithm, effort.n_steps, score)


METHODS: Mapping[str, Method] = MappingProxyType(
    {
        "registration": _registration,
        # Vertical and horizontal vergence: this model has no cyclovergence.
        "energy_model": partial(
            _read_out, entries=energy_model.entries, n_axes=2, places_share=0.15
        ),
        "ridge": partial(_read_out, entries=attrgetter("state"), n_axes=3, places_share=1.0),
        "cma_es": _cma_es,
        "sac": partial(_stable_baselines, algorithm="SAC"),
        "ppo": partial(_stable_baselines, algorithm="PPO"),
    }
)
