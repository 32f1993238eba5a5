"""The figures of each examination, by its name and what is added to the name of the file."""

from collections.abc import Callable, Mapping
from typing import Any

from matplotlib.figure import Figure

from active_binocular_vision.figures.examinations.clinic import (
    acuity_figure,
    cover_figure,
    prisms_figure,
    stereo_figure,
)
from active_binocular_vision.figures.examinations.lenses import accommodation_figure
from active_binocular_vision.figures.examinations.main_sequence import main_sequence_figure
from active_binocular_vision.figures.examinations.nine_positions import (
    activations_figure,
    hess_chart,
    listing_figure,
)

# Each draws the traces of what an examination found.
FIGURES: Mapping[str, Mapping[str, Callable[[Any], Figure]]] = {
    "cover": {"": cover_figure},
    "prisms": {"": prisms_figure},
    "acuity": {"": acuity_figure},
    "stereo": {"": stereo_figure},
    "accommodation": {"": accommodation_figure},
    "nine-positions": {
        "": hess_chart,
        "_activations": activations_figure,
        "_listing": listing_figure,
    },
    "main-sequence": {"": main_sequence_figure},
}
