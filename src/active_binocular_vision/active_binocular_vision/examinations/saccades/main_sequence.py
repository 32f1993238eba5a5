"""First saccades of frozen learners, simulated over time."""

import sys
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.contract.declared import DECLARED, MainSequenceOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import SHARE, key, measure
from active_binocular_vision.examinations.saccades.velocity import MainSequence, fitted
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import Session, check_looks_at_targets, session_of
from active_binocular_vision.learners.shown import Shown
from experiment_manager.measures.tables import number
from eye_plant.gaze_error import direction_deg as angles_of_direction_deg
from eye_plant.mechanics.movement import Movement, angles_deg, movements
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import InputError
from lockstep.machine.progress_lines import progress

Array = NDArray[np.float64]

_DISTANCE_M = 2.0
# The anatomical eyes creep: after two seconds they are where they stay.
_DURATION_S = 2.0
_INTERVAL_S = 0.002
# Eyes that turn less got no command to.
_RESTS_DEG = 1e-6


@dataclass(frozen=True, kw_only=True)
class SaccadeRow:
    """A first saccade of the left eye, whose picture has the target.

    target_deg, direction_deg: how far the target is, and where, counter-clockwise from the right,
    null for medians over directions; share_in_period: of the amplitude, how much is made within a
    control period; missed_deg: angle between target and line of sight once the eyes rest.
    """

    target_deg: float = key("target", "deg")
    direction_deg: float | None = measure("deg", "direction", is_shown=False)
    amplitude_deg: float = measure("deg", "amplitude", 2)
    peak_velocity_deg_s: float = measure("deg/s", "peak velocity", 1)
    duration_s: float = measure("s", "duration")
    share_in_period: float = measure(SHARE, "within a control period")
    missed_deg: float = measure("deg", "missed", 2)


_MEASURED = ("amplitude_deg", "peak_velocity_deg_s", "duration_s", "share_in_period", "missed_deg")


@dataclass(frozen=True, kw_only=True)
class MainSequenceSummary:
    """The fit to all saccades; null where velocity grows in proportion to amplitude.

    missed_deg: median over all saccades; control_period_s: of the eyes.
    """

    slope_per_s: float = measure("1/s", "velocity per amplitude", 1)
    constant_deg: float | None = measure("deg", "constant", 1)
    greatest_velocity_deg_s: float | None = measure("deg/s", "greatest velocity", 0)
    missed_deg: float = measure("deg", "missed", 2)
    control_period_s: float = measure("s", "control period")


@dataclass(frozen=True)
class MainSequenceTraces:
    """Each saccade with its movement over time, and the fit."""

    period_s: float
    saccades: Sequence[tuple[SaccadeRow, Movement]]
    fit: MainSequence


def _examine(learners: FrozenLearners, shown: Shown, options: MainSequenceOptions) -> Findings:
    """Let the eyes begin straight ahead, and simulate their first saccade to each target.

    A first saccade depends on target and activations alone, so one picture is enough.
    """
    check_looks_at_targets(learners, shown, "--main-sequence")
    eyes = Oculomotor(learners.plant.mechanics)
    places = [(a, d) for a in options.amplitudes_deg for d in options.directions_deg]
    with session_of(learners, replace(shown, n_most=1), 1) as session:
        saccades = [
            _saccade(session, eyes, *place)
            for place in progress(places, file=sys.stderr, desc="saccades", unit="saccade")
        ]
    rows = [row for row, _ in saccades]
    if max(row.amplitude_deg for row in rows) < _RESTS_DEG:
        raise InputError(
            "--main-sequence: expected learners that have learned saccades, got eyes that rest; "
            "train for longer"
        )
    fit = fitted(*(_column(rows, name) for name in ("amplitude_deg", "peak_velocity_deg_s")))
    return Findings(
        n_stimuli=session.n_pictures,
        summary=MainSequenceSummary(
            slope_per_s=fit.slope_per_s,
            constant_deg=fit.constant_deg,
            greatest_velocity_deg_s=fit.greatest_velocity_deg_s,
            missed_deg=float(np.median(_column(rows, "missed_deg"))),
            control_period_s=eyes.control_period_s,
        ),
        tables={
            "targets": [_medians(rows, target_deg) for target_deg in options.amplitudes_deg],
            "saccades": rows,
        },
        titles={"targets": "First saccades, left eye, medians over directions"},
        notes=_fit_text(fit),
        traces=MainSequenceTraces(eyes.control_period_s, saccades, fit),
    )


def _medians(rows: Sequence[SaccadeRow], target_deg: float) -> SaccadeRow:
    of_target = [row for row in rows if row.target_deg == target_deg]
    medians = {name: float(np.median(_column(of_target, name))) for name in _MEASURED}
    return SaccadeRow(target_deg=target_deg, direction_deg=None, **medians)


def _column(rows: Sequence[SaccadeRow], name: str) -> Array:
    return np.array([getattr(row, name) for row in rows])


def _fit_text(fit: MainSequence) -> str:
    slope = f"{number(fit.slope_per_s, 1)} per s"
    if fit.constant_deg is None:
        return f"peak velocity = {slope} x amplitude; it does not saturate"
    return (
        f"peak velocity = {number(fit.greatest_velocity_deg_s, 0)} deg/s x "
        f"(1 - exp(-amplitude / {number(fit.constant_deg, 1)} deg)); small saccades: {slope}"
    )


def place_deg(target_deg: float, direction_deg: float) -> Array:
    """Return azimuth (right) and elevation (2,) of a place so far from straight ahead.

    direction_deg: where it is, counter-clockwise from the right.
    """
    away, direction = np.radians([target_deg, direction_deg])
    aside = np.sin(away) * np.array([-np.cos(direction), np.sin(direction)])
    return angles_of_direction_deg(np.array([np.cos(away), *aside]))


def _saccade(
    session: Session, eyes: Oculomotor, target_deg: float, direction_deg: float
) -> tuple[SaccadeRow, Movement]:
    looking = session.eyes_as_healthy(0, _DISTANCE_M)
    first = np.array(looking.activations)
    end = looking.look(1, target_deg=place_deg(target_deg, direction_deg).tolist())
    n_intervals = round(_DURATION_S / _INTERVAL_S)
    left, _ = movements(eyes, first, end.activations, _DURATION_S, n_intervals)
    i_period = min(round(eyes.control_period_s / _INTERVAL_S), n_intervals)
    in_period_deg = float(angles_deg(left.sight[0], left.sight[i_period]))
    row = SaccadeRow(
        target_deg=target_deg,
        direction_deg=direction_deg,
        amplitude_deg=left.amplitude_deg,
        peak_velocity_deg_s=left.peak_velocity_deg_s,
        duration_s=left.duration_s,
        share_in_period=in_period_deg / max(left.amplitude_deg, _RESTS_DEG),
        missed_deg=end.missed_deg,
    )
    return row, left


MAIN_SEQUENCE = Examination(
    declared=DECLARED["main-sequence"],
    examine=_examine,
    summary=MainSequenceSummary,
)
