"""The examination of nine positions: its options, and how it is made."""

import numpy as np

from active_binocular_vision.examinations.contract.declared import DECLARED, NinePositionsOptions
from active_binocular_vision.examinations.contract.examination import Examination, Findings
from active_binocular_vision.examinations.nine_positions.looking import (
    NINE_POSITIONS_DEG,
    Looking,
    NinePositionsTraces,
    random_targets_deg,
)
from active_binocular_vision.examinations.nine_positions.measures import (
    active_muscles,
    antagonist_rows,
    distances,
    looks,
    medians,
    plane_rows,
    planes_of_eyes,
    planes_of_optimum,
    positions,
    tilts,
    yoked,
)
from active_binocular_vision.examinations.nine_positions.rows import (
    LEARNED,
    LEAST,
    NinePositionsSummary,
)
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import check_looks_at_targets, session_of
from active_binocular_vision.learners.shown import Shown

_N_PICTURES = 5


def _examine(learners: FrozenLearners, shown: Shown, options: NinePositionsOptions) -> Findings:
    """Let the eyes look; each look is an episode that begins straight ahead."""
    check_looks_at_targets(learners, shown, "--nine-positions")
    with session_of(learners, shown, _N_PICTURES) as session:
        looking = Looking(session, options.covered)
        n_pictures, distances_m = session.n_pictures, options.distances_m
        each = np.tile(np.arange(n_pictures), (len(NINE_POSITIONS_DEG), 1))
        in_turn = np.arange(options.n_random)[:, None] % n_pictures
        nine = looking.at(NINE_POSITIONS_DEG, distances_m, each)
        random = looking.at(random_targets_deg(options.n_random), distances_m, in_turn)
    traces = NinePositionsTraces(learners.plant, options.covered, nine, random)
    covered = f", {options.covered} eye covered" if options.covered else ""
    antagonists = antagonist_rows(traces)
    planes = {LEARNED: planes_of_eyes(traces), LEAST: planes_of_optimum(traces)}
    return Findings(
        n_stimuli=n_pictures,
        summary=NinePositionsSummary(
            **medians(nine, [*range(len(distances_m))]),
            active=antagonists[-1].active if antagonists else (np.nan,) * 3,
            active_muscles=active_muscles(nine, learners.plant),
        ),
        tables={
            "positions": [*positions(nine)],
            "distances": [*distances(nine)],
            "antagonists": antagonists,
            "planes": [row for eyes, of in planes.items() for row in plane_rows(eyes, of)],
            "tilts": [tilts(eyes, of) for eyes, of in planes.items()],
            "yoked": yoked(random),
            "looks": [*looks("nine", nine), *looks("random", random)],
        },
        titles={
            "positions": f"Medians over stimuli after {looking.n_iterations} iterations{covered}",
            "distances": "Medians over stimuli and positions, of absolute values",
            "antagonists": "Antagonists at the nine positions: how many of both are active",
            "planes": "Displacement planes of nine positions and random places",
            "tilts": "Temporal tilt of the plane per deg of vergence",
            "yoked": "Yoked muscles at random places",
        },
        traces=traces,
    )


NINE_POSITIONS = Examination(
    declared=DECLARED["nine-positions"],
    examine=_examine,
    summary=NinePositionsSummary,
    version=3,
)
