"""Accommodation: what moves the lenses, and what the lenses move.

Response: accommodation over the vergence of light from objects at several distances. Lens: the same
over lenses before both eyes. AC/A: vergence over accommodation while such lenses change it and one
eye is covered. CA/C: accommodation over vergence while prisms change that, through pinholes, which
leave no blur.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.contract.declared import DECLARED, AccommodationOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import (
    Quartiles,
    key,
    measure,
    prism_dioptres,
)
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import (
    NO_PRISM,
    Prism,
    Session,
    check_shows_pictures,
    session_of,
)
from active_binocular_vision.learners.shown import Shown
from eye_plant import desired_vergence_deg
from lockstep import InputError
from lockstep.machine.progress_lines import progress

Array = NDArray[np.float64]

_N_PICTURES = 5
_N_ITERATIONS = 20
# Where lenses and prisms are tried.
_DISTANCE_M = 1.0
_LENSES_D = (-1.0, -0.5, 0.5, 1.0)
# Base out above 0.
_PRISMS_DEG = (-1.0, -0.5, 0.5, 1.0)
_PINHOLES = {"lenses.pinhole_mm": (0.3, 0.3)}
# A slope over less than that is not known, in D and deg.
_LEAST_CHANGE = 0.1

NOTES = (
    "Human eyes: response 0.7 to 0.9 D/D, AC/A 4 PD/D (Morgan 1944), CA/C 0.06 to 0.1 D/PD. Lenses"
    " that the eyes make up for have -1 D/D."
)


@dataclass(frozen=True, kw_only=True)
class AccommodationRow:
    """Both eyes after some iterations with one stimulus, over pictures.

    stimulus: D of the object or of lenses, deg of prisms, base out above 0.
    """

    test: str = key("test")
    stimulus: float = key("stimulus")
    accommodation_d: Quartiles = measure("D", "accommodation", spread=True)
    vergence_deg: Quartiles = measure("deg", "vergence", spread=True)


@dataclass(frozen=True, kw_only=True)
class AccommodationSummary:
    """Medians over pictures of slopes; null where what they are over does not change."""

    response: float | None = measure("D/D", "response")
    lens: float | None = measure("D/D", "lens")
    ac_a_pd_d: float | None = measure("PD/D", "AC/A", 2)
    ca_c_d_pd: float | None = measure("D/PD", "CA/C")


# By the name of the test: stimuli (n,), and of each picture accommodation and vergence (n, 2).
Responses = Mapping[str, tuple[Sequence[float], Array]]


def _seen(
    session: Session, i_picture: int, distance_m: float, prism: Prism = NO_PRISM, **look: Any
) -> tuple[float, float]:
    """Return accommodation in D and vergence in deg of eyes that first see without the test."""
    eyes = session.eyes(i_picture, distance_m)
    eyes.look(_N_ITERATIONS)
    course = eyes.look(_N_ITERATIONS, prism=prism, **look)
    desired_deg = desired_vergence_deg(distance_m, session.learners.plant.mechanics.baseline_m)
    return float(course.accommodation_d.mean()), desired_deg - float(course.eyes_deg[-1, 0])


def _examine(learners: FrozenLearners, shown: Shown, options: AccommodationOptions) -> Findings:
    """Try each stimulus before each picture."""
    if not learners.manager.space.has_lenses:
        raise InputError(
            "--accommodation: expected eyes with lenses, as those of profile triad, got a run with "
            f"command_space {learners.manager.command_space}"
        )
    check_shows_pictures(shown, "--accommodation")
    found: dict[str, tuple[Sequence[float], Array]] = {}
    with session_of(learners, shown, _N_PICTURES) as session:
        for test, stimuli in progress(_tests(options), file=sys.stderr, unit="test"):
            seen = [
                [_seen(session, i, **how) for _, how in stimuli] for i in range(session.n_pictures)
            ]
            found[test] = [stimulus for stimulus, _ in stimuli], np.array(seen)
    return Findings(
        n_stimuli=session.n_pictures,
        summary=summary_of(found),
        tables={"responses": [*_rows(found)]},
        titles={"responses": "", "summary": "slopes"},
        notes=NOTES,
    )


def _tests(options: AccommodationOptions) -> list[tuple[str, list[tuple[float, dict[str, Any]]]]]:
    """Return the stimuli of each test, and what the eyes see with them."""
    lenses = [
        (lens_d, {"distance_m": _DISTANCE_M, "settings": _worn(lens_d)}) for lens_d in _LENSES_D
    ]
    prisms = [
        (
            deg,
            {
                "distance_m": _DISTANCE_M,
                "settings": _PINHOLES,
                "prism": Prism(rotation_deg=-deg),
            },
        )
        for deg in _PRISMS_DEG
    ]
    return [
        ("response", [(1.0 / m, {"distance_m": m}) for m in options.distances_m]),
        ("lens", lenses),
        ("lens, right eye covered", [(d, {**how, "covered": "right"}) for d, how in lenses]),
        ("prism, pinholes", prisms),
    ]


def _worn(lens_d: float) -> dict[str, Any]:
    return {"lenses.contact_lenses_d": (lens_d, lens_d)}


def summary_of(found: Responses) -> AccommodationSummary:
    """Return the slopes of what was found, by the names of `_tests`."""
    accommodation_d = {test: seen[..., 0] for test, (_, seen) in found.items()}
    vergence_pd = {test: _pd(seen[..., 1]) for test, (_, seen) in found.items()}
    covered, prism = "lens, right eye covered", "prism, pinholes"
    response, lens = (
        slope(np.broadcast_to(found[test][0], accommodation_d[test].shape), accommodation_d[test])
        for test in ("response", "lens")
    )
    return AccommodationSummary(
        response=response,
        lens=lens,
        ac_a_pd_d=slope(accommodation_d[covered], vergence_pd[covered]),
        ca_c_d_pd=slope(vergence_pd[prism], accommodation_d[prism]),
    )


def _pd(angles_deg: Array) -> Array:
    return np.vectorize(prism_dioptres, otypes=[float])(angles_deg)


def slope(x: Array, y: Array) -> float | None:
    """Return the median over pictures of the slope of y over x, (n_pictures, n_stimuli).

    By least squares; None where x hardly changes before most pictures.
    """
    changes = x - x.mean(axis=1, keepdims=True)
    squares = (changes**2).sum(axis=1)
    is_known = np.ptp(x, axis=1) >= _LEAST_CHANGE
    if is_known.mean() <= 0.5:
        return None
    return float(np.median((changes * y).sum(axis=1)[is_known] / squares[is_known]))


def _rows(found: Responses) -> list[AccommodationRow]:
    return [
        AccommodationRow(
            test=test,
            stimulus=stimulus,
            accommodation_d=Quartiles.of(seen[:, i, 0]),
            vergence_deg=Quartiles.of(seen[:, i, 1]),
        )
        for test, (stimuli, seen) in found.items()
        for i, stimulus in enumerate(stimuli)
    ]


ACCOMMODATION = Examination(
    declared=DECLARED["accommodation"],
    examine=_examine,
    summary=AccommodationSummary,
)
