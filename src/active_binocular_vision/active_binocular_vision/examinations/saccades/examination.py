"""First saccades of frozen learners, simulated over time."""

import dataclasses
import sys
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.positions.targets import (
    activations_ahead,
    check_looks_at_targets,
)
from active_binocular_vision.examinations.positions.targets import (
    direction_deg as angles_of_direction_deg,
)
from active_binocular_vision.examinations.saccades.main_sequence import MainSequence, fitted
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import OWN_TEST_STIMULI, Shown
from active_binocular_vision.learners.viewing import Viewing
from experiment_manager.in_process.loop import InProcessLoop
from experiment_manager.measures.tables import number, percent, text_table
from experiment_manager.terminal.progress_lines import progress
from eye_plant.mechanics.movement import Movement, angles_deg, movements
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import InputError

Array = NDArray[np.float64]

AMPLITUDES_DEG = (1.0, 2.0, 5.0, 10.0, 15.0, 20.0)
# Of targets, counter-clockwise from the right.
DIRECTIONS_DEG = tuple(45.0 * i for i in range(8))
_DISTANCE_M = 2.0
# The anatomical eyes creep: after two seconds they are where they stay.
_DURATION_S = 2.0
_INTERVAL_S = 0.002
# Eyes that turn less got no command to.
_RESTS_DEG = 1e-6


@dataclass(frozen=True)
class Saccade:
    """A first saccade of the left eye, whose picture has the target.

    target_deg, direction_deg: how far the target is, and where, counter-clockwise from the right;
    missed_deg: angle between target and line of sight once the eyes rest; share_in_period: of the
    amplitude, how much is made within a control period.
    """

    target_deg: float
    direction_deg: float
    missed_deg: float
    share_in_period: float
    movement: Movement

    def measures(self) -> dict[str, float]:
        """Return the numbers by name."""
        return {
            "target_deg": self.target_deg,
            "direction_deg": self.direction_deg,
            "missed_deg": self.missed_deg,
            "share_in_period": self.share_in_period,
            "amplitude_deg": self.movement.amplitude_deg,
            "peak_velocity_deg_s": self.movement.peak_velocity_deg_s,
            "duration_s": self.movement.duration_s,
        }


@dataclass(frozen=True)
class Saccades:
    """What the examination found."""

    learners: FrozenLearners
    stimuli: str
    period_s: float
    saccades: tuple[Saccade, ...]

    @cached_property
    def measures(self) -> list[dict[str, float]]:
        """The numbers of each saccade."""
        return [saccade.measures() for saccade in self.saccades]

    @cached_property
    def main_sequence(self) -> MainSequence:
        """The fit to all saccades."""
        names = "amplitude_deg", "peak_velocity_deg_s"
        return fitted(*(np.array([m[name] for m in self.measures]) for name in names))

    def to_json(self) -> dict[str, Any]:
        """Return what evaluate.sh writes."""
        fit = self.main_sequence
        velocity = {"greatest_velocity_deg_s": fit.greatest_velocity_deg_s}
        return self.learners.said() | {
            "stimuli": self.stimuli,
            "n_stimuli": 1,
            "object_distance_m": _DISTANCE_M,
            "control_period_s": self.period_s,
            "saccades": self.measures,
            "main_sequence": vars(fit) | velocity,
        }

    def table(self) -> str:
        """Return the measures as text."""
        header = ["target/deg", "amplitude/deg", "peak velocity/(deg/s)", "duration/ms"]
        header += [f"within {1e3 * self.period_s:.0f} ms", "missed/deg"]
        table = text_table(header, [*map(self._row, AMPLITUDES_DEG)], n_left=0)
        return f"First saccades, left eye, medians over directions\n{table}\n\n{self._fit_text()}"

    def _row(self, target_deg: float) -> list[str]:
        of = [m for m in self.measures if m["target_deg"] == target_deg]

        def median(name: str) -> float:
            return float(np.median([m[name] for m in of]))

        return [
            f"{target_deg:g}",
            number(median("amplitude_deg"), 2),
            number(median("peak_velocity_deg_s"), 1),
            number(1e3 * median("duration_s"), 0),
            percent(median("share_in_period")),
            number(median("missed_deg"), 2),
        ]

    def _fit_text(self) -> str:
        fit = self.main_sequence
        slope = f"{number(fit.slope_per_s, 1)} per s"
        if fit.constant_deg is None:
            return f"peak velocity = {slope} x amplitude; it does not saturate"
        return (
            f"peak velocity = {number(fit.greatest_velocity_deg_s, 0)} deg/s x "
            f"(1 - exp(-amplitude / {number(fit.constant_deg, 1)} deg)); small saccades: {slope}"
        )


def examine_saccades(learners: FrozenLearners, shown: Shown = OWN_TEST_STIMULI) -> Saccades:
    """Let the eyes begin straight ahead, and simulate their first saccade to each target.

    A first saccade depends on target and activations alone, so one picture is enough. Raises
    InputError for learners or pictures that cannot be used.
    """
    check_looks_at_targets(learners, shown, "--main-sequence")
    stimuli = dataclasses.replace(shown, n_most=1).load(learners.plant.stimuli, 1)
    eyes = Oculomotor(learners.manager.mechanics)
    first = activations_ahead(learners, eyes.eye_positions_m(), _DISTANCE_M)
    places = [(a, d) for a in AMPLITUDES_DEG for d in DIRECTIONS_DEG]
    with learners.loop(stimuli) as loop:
        saccades = tuple(
            _saccade(loop, eyes, first, *place)
            for place in progress(places, file=sys.stderr, desc="saccades", unit="saccade")
        )
    if max(saccade.movement.amplitude_deg for saccade in saccades) < _RESTS_DEG:
        raise InputError(
            "--main-sequence: expected learners that have learned saccades, got eyes that rest; "
            "train for longer"
        )
    return Saccades(learners, shown.text, eyes.control_period_s, saccades)


def place_deg(target_deg: float, direction_deg: float) -> Array:
    """Return azimuth (right) and elevation (2,) of a place so far from straight ahead.

    direction_deg: where it is, counter-clockwise from the right.
    """
    away, direction = np.radians([target_deg, direction_deg])
    aside = np.sin(away) * np.array([-np.cos(direction), np.sin(direction)])
    return angles_of_direction_deg(np.array([np.cos(away), *aside]))


def _saccade(
    loop: InProcessLoop, eyes: Oculomotor, first: Array, target_deg: float, direction_deg: float
) -> Saccade:
    viewing = Viewing(loop, 0, _DISTANCE_M, first.tolist())
    end = viewing.look(1, targets_deg=place_deg(target_deg, direction_deg).tolist())[-1]
    n_intervals = round(_DURATION_S / _INTERVAL_S)
    left, _ = movements(eyes, first, end.state.activations, _DURATION_S, n_intervals)
    i_period = round(eyes.control_period_s / _INTERVAL_S)
    in_period_deg = float(angles_deg(left.sight[0], left.sight[i_period]))
    return Saccade(
        target_deg,
        direction_deg,
        missed_deg=float(np.hypot(*end.truth.target_deg)),
        share_in_period=in_period_deg / max(left.amplitude_deg, _RESTS_DEG),
        movement=left,
    )
