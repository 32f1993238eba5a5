"""The methods, by name: each is tested on a run's bench, once or as it learns."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from operator import attrgetter
from types import MappingProxyType

import numpy as np

from active_binocular_vision.baselines import energy_model
from active_binocular_vision.baselines.bench import Bench, Controller
from active_binocular_vision.baselines.command_search import (
    CommandSearch,
    best_so_far,
    first_looks,
)
from active_binocular_vision.baselines.deep_rl import train
from active_binocular_vision.baselines.read_out import Entries, calibrated_sensor
from active_binocular_vision.baselines.registration import Registration
from active_binocular_vision.baselines.turning import MotorMap, Sensor, steering
from experiment_manager import Trials
from lockstep import PAIR

# A search is shown after as many looks as a trial has, and after so many.
_SHOWN_LOOKS = (20, 100, 300)
_N_SCORES = 5


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
    """One of `every` trials is made; n_steps: of training; n_places: to calibrate."""

    every: int = 11
    n_steps: int = 20_000
    n_places: int = 20_000
    n_looks: int = 300


Method = Callable[[Bench, Effort], Iterator[Tested]]


def _registration(bench: Bench, effort: Effort) -> Iterator[Tested]:
    sensor = Registration(bench.plant.config.camera.focal_length_px)
    yield Tested(0, bench.trials(_steering(bench, sensor), effort.every))


def _read_out(
    bench: Bench, effort: Effort, entries: Entries, n_axes: int, places_share: float
) -> Iterator[Tested]:
    motor = MotorMap(bench.manager, bench.plant.config)
    n_axes = 1 if bench.manager.command_space == PAIR else n_axes
    n_places = round(places_share * effort.n_places)
    sensor = calibrated_sensor(bench, motor, entries, n_axes, n_places)
    yield Tested(n_places, bench.trials(steering(sensor, motor), effort.every))


def _cma_es(bench: Bench, effort: Effort) -> Iterator[Tested]:
    search = CommandSearch(bench.manager.space, bench.manager.limits, bench.manager.seed)
    trials = bench.trials(search, effort.every, effort.n_looks + 1)
    found = best_so_far(trials, np.array(search.costs))
    shown = {n for n in _SHOWN_LOOKS if n < effort.n_looks} | {effort.n_looks}
    for n_looks in sorted(shown):
        yield Tested(0, first_looks(found, n_looks), n_looks)


def _stable_baselines(bench: Bench, effort: Effort, algorithm: str) -> Iterator[Tested]:
    scores: list[Tested] = []

    def score(n_steps: int, controller: Controller) -> None:
        scores.append(Tested(n_steps, bench.trials(controller, effort.every)))

    train(bench, algorithm, effort.n_steps, score, effort.n_steps // _N_SCORES)
    yield from scores


def _steering(bench: Bench, sensor: Sensor) -> Controller:
    return steering(sensor, MotorMap(bench.manager, bench.plant.config))


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
