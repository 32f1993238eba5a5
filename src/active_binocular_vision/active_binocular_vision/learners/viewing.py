"""Eyes that stay where they came to while an experimenter changes what they see."""

from collections.abc import Mapping, Sequence
from typing import Any

from experiment_manager.in_process.loop import InProcessLoop
from eye_plant import Episode, Observation
from sparse_coder import Encoding


class Viewing:
    """One plane, looked at for as long as wanted, in parts that differ in the plant's settings.

    Each part is an episode that begins with the activations at which the one before ended. The eyes
    rest between commands, so nothing else carries over.
    """

    def __init__(
        self,
        loop: InProcessLoop,
        stimulus: int,
        object_distance_m: float,
        activations: Sequence[float],
    ) -> None:
        """stimulus: counted from 0; activations: (12,) of the first part's beginning."""
        self._loop = loop
        self._stimulus = stimulus
        self._distance_m = object_distance_m
        self._activations = tuple(activations)

    def look(
        self,
        n_iterations: int,
        settings: Mapping[str, Any] | None = None,
        targets_deg: Sequence[float] = (),
    ) -> list[Observation]:
        """Let the eyes move so many times; return the n_iterations + 1 observations.

        The first one shows the eyes where they were, with the new settings; pictures of all but the
        last are overwritten. settings: of the plant, by dotted name, instead of those of the
        learners' own; targets_deg: as an episode's. Raises InputError for settings that the plant
        cannot have.
        """
        self._loop.plant.reconfigure(settings or {})
        steps = self._loop.run_episode(self._episode(n_iterations, targets_deg), learning=False)
        observations = [step.observation for step in steps]
        self._activations = tuple(observations[-1].state.activations.tolist())
        return observations

    def code(self) -> Encoding:
        """Return the code of what the eyes see now, without settings; they do not move."""
        self._loop.plant.reconfigure({})
        observation = self._loop.plant.begin(self._episode(1, ()))
        assert observation.pictures is not None
        return self._loop.coder.encode(*observation.pictures)

    def _episode(self, n_iterations: int, targets_deg: Sequence[float]) -> Episode:
        return Episode.alone(
            self._stimulus, self._distance_m, self._activations, n_iterations, targets_deg
        )
