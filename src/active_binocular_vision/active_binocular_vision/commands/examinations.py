"""The clinic's part of evaluate.sh's command line: which examination, and its figure."""

import argparse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

from active_binocular_vision.examinations import acuity, cover, prisms
from active_binocular_vision.examinations.positions.document import examine_positions
from active_binocular_vision.examinations.saccades.examination import examine_saccades
from active_binocular_vision.figures import clinic as figures
from active_binocular_vision.figures.main_sequence import main_sequence_figure
from active_binocular_vision.figures.nine_positions import (
    activations_figure,
    hess_chart,
    listing_figure,
)
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.shown import Shown
from lockstep import SIDES, InputError
from lockstep.figures import STYLE, save


@dataclass(frozen=True)
class Examination:
    """An examination: how it is made, what --help says of it, and how its figures are drawn.

    examine: what it returns has `to_json` and `table`; figures: by what is added to the name of the
    file.
    """

    examine: Callable[..., Any]
    text: str
    figures: Mapping[str, Callable[[Any], Figure]]


NINE_POSITIONS = "nine-positions"


EXAMINATIONS = {
    "cover": Examination(
        cover.examine,
        "cover one eye, then the other: phoria, and how the eyes fuse again",
        {"": figures.cover_figure},
    ),
    "prisms": Examination(
        prisms.examine,
        "turn the right eye's picture as prisms do, until the eyes no longer fuse",
        {"": figures.prisms_figure},
    ),
    "acuity": Examination(
        acuity.examine,
        "measure the acuity of each eye, the stereo threshold, and each eye's share in the code",
        {"": figures.acuity_figure},
    ),
    NINE_POSITIONS: Examination(
        examine_positions,
        "show nine gaze targets at three distances to eyes that make saccades: Hess chart, energy"
        " beside the least, and the laws of Sherrington, Listing and Hering",
        {
            "": lambda results: hess_chart(results.examined),
            "_activations": lambda results: activations_figure(results.examined),
            "_listing": lambda results: listing_figure(results.examined),
        },
    ),
    "main-sequence": Examination(
        examine_saccades,
        "simulate first saccades of 1 to 20 deg over time: amplitude, peak velocity, duration",
        {"": main_sequence_figure},
    ),
}


def add_examinations(parser: argparse.ArgumentParser) -> None:
    """Add the options; they leave `examination`, None or a name, and `figure`."""
    group = parser.add_argument_group("examinations of the learners, as in an eye clinic")
    choice = group.add_mutually_exclusive_group()
    for name, examination in EXAMINATIONS.items():
        choice.add_argument(
            f"--{name}",
            action="store_const",
            const=name,
            dest="examination",
            help=examination.text,
        )
    group.add_argument(
        "--figure", type=Path, metavar="FILE.png", help="also draw what the examination found"
    )
    group.add_argument(
        "--cover-eye",
        choices=SIDES,
        help=f"cover an eye in --{NINE_POSITIONS}; only the right one, since the left picture has"
        " the target",
    )


def examined(
    name: str, learners: FrozenLearners, shown: Shown, figure: Path | None, **how: Any
) -> tuple[dict[str, Any], str]:
    """Make an examination and draw its figures; return the measures as a document and as text.

    how: what this examination takes besides. Raises InputError for what cannot be examined.
    """
    if figure is not None and figure.suffix.lower() != ".png":
        raise InputError(f"--figure: expected a name that ends in .png, got {figure}")
    examination = EXAMINATIONS[name]
    results = examination.examine(learners, shown, **how)
    if figure is not None:
        with mpl.rc_context(STYLE):
            for addition, draw in examination.figures.items():
                save(draw(results), figure.with_stem(f"{figure.stem}{addition}"))
    return results.to_json(), results.table()
