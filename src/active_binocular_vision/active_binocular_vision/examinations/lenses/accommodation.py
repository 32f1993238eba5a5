"""Accommodation: what moves the lenses, and what the lenses move.

Response: accommodation over the dioptres of objects that come nearer. Lenses: the same over what
lenses before both eyes ask for. AC/A: vergence over that stimulus, or over the accommodation of the
eye that sees, while the other one is covered (gradient method). CA/C: accommodation over vergence
while prisms change that, through pinholes, which leave no blur. Slopes are over stimuli from 0 D to
those of the nearest object of training.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.clinic.psychometric import resampled
from active_binocular_vision.examinations.contract.declared import (
    DECLARED,
    AccommodationOptions,
    TrialFrame,
)
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.contract.measure import (
    Quartiles,
    key,
    measure,
    measures_of,
    prism_dioptres,
)
from active_binocular_vision.examinations.contract.trial_frame import held
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import (
    Eyes,
    Prism,
    Session,
    check_has_lenses,
    check_shows_pictures,
    session_of,
)
from active_binocular_vision.learners.shown import Shown
from eye_plant import desired_vergence_deg
from eye_plant.gaze_error import direction_deg
from lockstep.machine.progress_lines import progress

Array = NDArray[np.float64]

_N_PICTURES = 5
_N_ITERATIONS = 20
LENSES_D = (2.0, 1.0, 0.0, -1.0, -2.0)
# Base out above 0.
PRISMS_PD = (-4.0, -2.0, 0.0, 2.0, 4.0)
_PINHOLES_MM = (0.3, 0.3)
# A slope over less than that is not known, in D or PD.
_LEAST_CHANGE = 0.1

RESPONSE, LENSES, COVERED, PRISMS = TESTS = (
    "objects",
    "lenses",
    "lenses, right eye covered",
    "prisms, pinholes",
)


@dataclass(frozen=True)
class Norm:
    """What human eyes have: mean and SD, or the ends of a range, and whose numbers these are."""

    text: str
    low: float
    high: float


# Gradient AC/A of 23 adults, SD 2.17 and 1.31: Bhoola, Bruce & Atchison 1995 (Clin. Exp. Optom. 78,
# 3-10). CA/C of 26 adults with prisms at 0.4 m: Hirani & Firth 2009, doi 10.22599/bioj.11; 0.06 to
# 0.1 is usual, too. Response: usual in textbooks.
NORMS = {
    "response": Norm("0.7 to 0.9", 0.7, 0.9),
    "stimulus_ac_a": Norm("3.5 +- 2.2", 1.32, 5.66),
    "response_ac_a": Norm("4.4 +- 1.3", 3.06, 5.68),
    "ca_c": Norm("0.13 +- 0.04", 0.09, 0.17),
}


@dataclass(frozen=True, kw_only=True)
class AccommodationRow:
    """Both eyes after some iterations with one stimulus, over pictures.

    stimulus: dioptres of the object, power of lenses in D or of prisms in PD, base out above 0;
    accommodation_d: of the eyes that see, their mean.
    """

    test: str = key("test")
    stimulus: float = key("stimulus")
    accommodation_d: Quartiles = measure("D", "accommodation", 2, spread=True)
    vergence_pd: Quartiles = measure("PD", "vergence", 2, spread=True)


@dataclass(frozen=True, kw_only=True)
class SlopeRow:
    """One slope, over pictures; null where what it is over does not change.

    interval: 95 % of the median, a bootstrap over pictures.
    """

    slope: str = key("slope")
    unit: str = measure("", "unit")
    median: float | None = measure("", "median")
    interval: Sequence[float | None] = measure(
        "", "interval", columns=("low", "high"), labels=("from", "to")
    )
    human: str = measure("", "human")


@dataclass(frozen=True, kw_only=True)
class AccommodationSummary:
    """Medians over pictures of slopes; null where what they are over does not change."""

    response: float | None = measure("D/D", "response")
    lens_response: float | None = measure("D/D", "response to lenses")
    stimulus_ac_a: float | None = measure("PD/D", "stimulus AC/A", 2)
    response_ac_a: float | None = measure("PD/D", "response AC/A", 2)
    ca_c: float | None = measure("D/PD", "CA/C")


@dataclass(frozen=True)
class AccommodationTraces:
    """By the name of a test: stimuli (n,), and of each picture what the eyes did, (n,).

    distance_d: where lenses and prisms were tried; trained_d: of the nearest object of training;
    geometry_pd_d: vergence over accommodation of eyes that fuse and focus every object.
    """

    stimuli: Mapping[str, Array]
    accommodation_d: Mapping[str, Array]
    vergence_pd: Mapping[str, Array]
    distance_d: float
    trained_d: float
    geometry_pd_d: float


def _responses(
    session: Session, i_picture: int, objects_d: Sequence[float], options: AccommodationOptions
) -> list[Array]:
    """Return accommodation in D and vergence in PD (n, 2) of each test before one picture."""
    eyes = session.eyes(i_picture, 1.0 / objects_d[0])
    objects = []
    for object_d in objects_d:
        eyes = eyes.before(1.0 / object_d)
        objects.append(_seen(eyes))
    settled = session.eyes(i_picture, options.distance_m)
    settled.look(_N_ITERATIONS)

    def seen(**look: Any) -> tuple[float, float]:
        return _seen(settled.before(options.distance_m), **look)

    plant = session.learners.plant
    lenses = [held(plant, TrialFrame(lenses_d=(lens_d, lens_d))) for lens_d in LENSES_D]
    prisms = [Prism(rotation_deg=-float(np.degrees(np.arctan(pd / 100.0)))) for pd in PRISMS_PD]
    pinholes = held(plant, TrialFrame(pinholes_mm=_PINHOLES_MM))
    of_tests = (
        objects,
        [seen(settings=worn) for worn in lenses],
        [seen(settings=worn, covered="right") for worn in lenses],
        [seen(settings=pinholes, prism=prism) for prism in prisms],
    )
    return [np.array(of_test) for of_test in of_tests]


def _seen(eyes: Eyes, **look: Any) -> tuple[float, float]:
    course = eyes.look(_N_ITERATIONS, **look)
    n_seeing = 1 if look.get("covered") else 2  # the left one
    left_deg, right_deg = direction_deg(course.lines_of_sight[-1])[:, 0].tolist()
    vergence_pd = prism_dioptres(left_deg - right_deg)
    assert vergence_pd is not None
    return float(course.lens_state.accommodation_d[:n_seeing].mean()), vergence_pd


def _examine(learners: FrozenLearners, shown: Shown, options: AccommodationOptions) -> Findings:
    """Make all tests before each picture."""
    check_has_lenses(learners, "--accommodation")
    check_shows_pictures(shown, "--accommodation")
    with session_of(learners, shown, _N_PICTURES) as session:
        farthest_d, *nearer_d = sorted(options.objects_d)
        objects_d = [farthest_d, *(d for d in nearer_d if session.shows(1.0 / d))]
        pictures = progress(range(session.n_pictures), file=sys.stderr, unit="picture")
        seen = zip(*[_responses(session, i, objects_d, options) for i in pictures], strict=True)
    stimuli = map(np.array, (objects_d, LENSES_D, LENSES_D, PRISMS_PD))
    by_test = {test: np.array(of_test) for test, of_test in zip(TESTS, seen, strict=True)}
    geometry_deg = desired_vergence_deg(options.distance_m, learners.plant.mechanics.baseline_m)
    traces = AccommodationTraces(
        dict(zip(TESTS, stimuli, strict=True)),
        {test: of_test[..., 0] for test, of_test in by_test.items()},
        {test: of_test[..., 1] for test, of_test in by_test.items()},
        1.0 / options.distance_m,
        1.0 / min(learners.manager.object_distance_m),
        100.0 * np.tan(np.radians(geometry_deg)) * options.distance_m,
    )
    slopes = slopes_of(traces)
    return Findings(
        n_stimuli=session.n_pictures,
        summary=AccommodationSummary(**{name: median(of) for name, of in slopes.items()}),
        tables={
            "slopes": [_slope_row(name, of) for name, of in slopes.items()],
            "responses": _rows(traces),
        },
        titles={"slopes": "", "responses": "medians over pictures"},
        notes=f"Eyes that fuse and focus every object have {traces.geometry_pd_d:.1f} PD/D.",
        traces=traces,
    )


def slopes_of(found: AccommodationTraces) -> dict[str, Array]:
    """Return the slopes before each picture, (n_pictures,), by the names of the summary."""

    def asked(stimuli_d: Array) -> tuple[Array, NDArray[np.bool_]]:
        is_trained = (stimuli_d >= 0.0) & (stimuli_d <= found.trained_d)
        return stimuli_d[is_trained], is_trained

    objects_d, objects = asked(found.stimuli[RESPONSE])
    lenses_d, lenses = asked(found.distance_d - found.stimuli[LENSES])
    accommodation_d, vergence_pd = found.accommodation_d, found.vergence_pd
    covered_pd, covered_d = vergence_pd[COVERED][:, lenses], accommodation_d[COVERED][:, lenses]
    return {
        "response": slope(objects_d, accommodation_d[RESPONSE][:, objects]),
        "lens_response": slope(lenses_d, accommodation_d[LENSES][:, lenses]),
        "stimulus_ac_a": slope(lenses_d, covered_pd),
        "response_ac_a": slope(covered_d, covered_pd),
        "ca_c": slope(vergence_pd[PRISMS], accommodation_d[PRISMS]),
    }


def slope(x: Array, y: Array) -> Array:
    """Return the slope of y (n_pictures, n_stimuli) over x of each picture, by least squares.

    x: (n_stimuli,) or as y. NaN where x hardly changes.
    """
    x = np.broadcast_to(x, y.shape)
    changes = x - x.mean(axis=1, keepdims=True)
    is_known = np.ptp(x, axis=1) >= _LEAST_CHANGE
    squares = np.where(is_known, (changes**2).sum(axis=1), np.nan)
    slopes: Array = (changes * y).sum(axis=1) / squares
    return slopes


def median(slopes: Array) -> float | None:
    """Return the median of those that are known, None unless more than half are."""
    known = slopes[np.isfinite(slopes)]
    return float(np.median(known)) if 2 * len(known) > len(slopes) else None


def _slope_row(name: str, slopes: Array) -> SlopeRow:
    known = slopes[np.isfinite(slopes)]
    middle, declared = median(slopes), measures_of(AccommodationSummary)[name]
    interval = (
        None
        if middle is None
        else resampled(len(known), lambda drawn: float(np.median(known[drawn])))
    )
    return SlopeRow(
        slope=declared.label,
        unit=declared.unit,
        median=middle,
        interval=interval or (None, None),
        human=NORMS[name].text if name in NORMS else "-",
    )


def _rows(found: AccommodationTraces) -> list[AccommodationRow]:
    return [
        AccommodationRow(
            test=test,
            stimulus=float(stimulus),
            accommodation_d=Quartiles.of(found.accommodation_d[test][:, i]),
            vergence_pd=Quartiles.of(found.vergence_pd[test][:, i]),
        )
        for test, stimuli in found.stimuli.items()
        for i, stimulus in enumerate(stimuli)
    ]


ACCOMMODATION = Examination(
    declared=DECLARED["accommodation"],
    examine=_examine,
    summary=AccommodationSummary,
    version=2,
)
