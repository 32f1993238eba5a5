"""The test of a run for whoever commands its eyes: the same eyes, pictures, starts and measures."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import astuple, dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.runs.run import Run
from experiment_manager import ExperimentManagerConfig, Trials, protocol_of
from experiment_manager.measures.trials import TrialTable, only_test
from experiment_manager.sections import config_of
from eye_plant import Episode, EyePlant, EyePlantConfig, Observation
from lockstep import InputError
from sparse_coder import Encoding, SparseCoder, SparseCoderConfig

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Seen:
    """What a controller is given of an observation.

    pictures: (2, height_px, width_px) uint8, left then right; activations: (12,), as they are felt;
    iteration: of the episode, 0 at its start; coder: of the run, which learns no more.
    """

    pictures: NDArray[np.uint8]
    activations: Array
    iteration: int
    coder: SparseCoder

    @cached_property
    def code(self) -> Encoding:
        """The pictures' sparse code."""
        return self.coder.encode(*self.pictures)

    @property
    def state(self) -> Array:
        """Square roots of the features, and the activations, (n,): what our rules act on (D15)."""
        return np.concatenate((np.sqrt(self.code.features.ravel()), self.activations))

    @property
    def error(self) -> float:
        """E of both scales (K17 eq. 2)."""
        return float(self.code.reconstruction_error.sum())


# Returns the next activations (n_commands,) of what was seen; the limits are applied to them.
Controller = Callable[[Seen], Array]


class Bench:
    """Eyes and dictionaries of a run, before the run's own pictures."""

    def __init__(self, run: Run, coder_state: Mapping[str, NDArray[Any]]) -> None:
        """run: with its configuration; coder_state: as saved by it.

        Raises InputError for a run whose eyes make saccades or have lenses, and for a state that
        does not fit.
        """
        configuration = run.configuration
        self.directory = run.directory
        # {"SECTION.NAME": value}: what the run looks at.
        self.stimuli = {
            f"eye_plant.{name}": value
            for name, value in configuration["eye_plant"].items()
            if name.startswith("stimuli.")
        }
        self.manager = config_of(ExperimentManagerConfig, configuration)
        fixation, space = self.manager.fixation_iterations, self.manager.space
        if fixation or space.has_lenses:
            raise InputError(
                "baselines: expected a run without saccades and lenses, as those of precise and "
                f"twelve, got fixation_iterations {fixation}, command_space "
                f"{self.manager.command_space}"
            )
        self.protocol = protocol_of(configuration)
        self._coder = SparseCoder(config_of(SparseCoderConfig, configuration))
        self._coder.restore(coder_state)
        self.plant = EyePlant(config_of(EyePlantConfig, configuration))
        self._limits = tuple(map(np.array, vars(self.manager.limits).values()))

    def observations(self, controller: Controller, episode: Episode) -> Iterator[Observation]:
        """Yield the observations of an episode, of which the last one is not answered."""
        seen = self.plant.begin(episode)
        while seen.pictures is not None:
            yield seen
            seen = self.executed(controller(self.given(seen)))
        yield seen

    def executed(self, command: Array) -> Observation:
        """Return what follows from a command (n_commands,), within the limits."""
        within = np.clip(command, *self._limits)
        return self.plant.execute(self.plant.targets(self.manager.space.names, within))

    def given(self, seen: Observation) -> Seen:
        """Return what a controller is given of an observation with pictures."""
        assert seen.pictures is not None
        return Seen(seen.pictures, seen.felt, seen.iteration, self._coder)

    def trials(
        self, controller: Controller, every: int = 1, n_iterations: int | None = None
    ) -> Trials:
        """Return one of `every` trials of the test, with the controller's commands.

        n_iterations: of each trial, unless the run's own number.
        """
        test = self.protocol.segments[-1]
        n = n_iterations or self.manager.iterations_per_trial
        rows: list[tuple[float, ...]] = []
        for place in range(test.first, test.first + test.n_episodes, every):
            episode = replace(self.protocol.episode(place), n_iterations=n)
            rows += map(self._row, self.observations(controller, episode))
        table = TrialTable(np.array(rows, dtype=np.float64), self.manager.space)
        return only_test(table, n)

    def close(self) -> None:
        """Release what the camera holds."""
        self.plant.close()

    def _row(self, seen: Observation) -> tuple[float, ...]:
        commanded = self.manager.space.from_all(seen.state.activations)
        return (*seen.ground_truth_values(), *commanded)


def errors_deg(seen: Observation) -> Array:
    """Return the true errors (3,), signed as GazeError's: no controller is given them."""
    return np.array(astuple(seen.truth.gaze_error))
