"""The sparse coder's basis functions as left-right pairs, with the disparity that each prefers."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FormatStrFormatter

from active_binocular_vision.figures.style import GREY, WIDTH_IN, new_figure, title_panels
from active_binocular_vision.learners.basis_functions import (
    LARGEST_SHIFT_PX,
    dominance,
    preferred_disparity_px,
)
from lockstep import InputError
from lockstep.scales import PATCH_SIZE_PX, ScalesConfig
from sparse_coder.patches import N_PIXELS

_N_COLUMNS = 16
_N_BINS = 37  # odd: one is centred on 0
_DEFAULT = ScalesConfig()


def dictionary_figure(atoms: np.ndarray, scales: ScalesConfig = _DEFAULT) -> Figure:
    """Return the dictionaries (n_scales, n_bases, 128), sorted, over their preferred disparities.

    Each tile is an atom, left eye beside right eye, grey at 0, scaled by its largest entry.
    Atoms that prefer a disparity come first, in its order; then the others, most balanced first.
    """
    if atoms.ndim != 3 or len(atoms) != len(scales.all):
        shape = f"{len(scales.all)}, n_bases"
        raise InputError(f"expected atoms ({shape}, {N_PIXELS}), got shape {atoms.shape}")
    figure = new_figure(WIDTH_IN, 4.6)
    tiles, histograms = figure.subplots(2, len(atoms), squeeze=False, height_ratios=(3.2, 1))
    titles = []
    for i, scale in enumerate(scales.all):
        disparity_px = preferred_disparity_px(atoms[i], scale.px_per_pixel)
        order = np.lexsort((np.abs(dominance(atoms[i])), disparity_px))
        tiles[i].imshow(_mosaic(atoms[i][order]), cmap="gray", vmin=-1, vmax=1)
        tiles[i].set_axis_off()
        known_px = disparity_px[~np.isnan(disparity_px)]
        titles.append(f"{scale.name} scale, left | right eye, by disparity")
        reach = (LARGEST_SHIFT_PX + 0.5) * scale.px_per_pixel
        histograms[i].hist(known_px, bins=np.linspace(-reach, reach, _N_BINS + 1), color=GREY)
        # Nearly all prefer no disparity; the few others must show, too.
        if not len(known_px):
            histograms[i].set_ylim(0.7, 10.0)
        histograms[i].set_yscale("log")
        histograms[i].yaxis.set_major_formatter(FormatStrFormatter("%g"))
        histograms[i].set(xlabel="preferred disparity / px", xlim=(-reach, reach), ylim=(0.7, None))
        titles.append(f"the {len(known_px)} of {len(atoms[i])} with a preferred disparity")
    title_panels((*tiles, *histograms), (*titles[::2], *titles[1::2]))
    histograms[0].set_ylabel("basis functions")
    return figure


def _mosaic(atoms: np.ndarray) -> np.ndarray:
    """Return atoms as tiles, _N_COLUMNS in a row, white lines between them."""
    n_rows = -(-len(atoms) // _N_COLUMNS)
    height, width = PATCH_SIZE_PX + 1, 2 * PATCH_SIZE_PX + 3
    mosaic = np.ones((n_rows * height + 1, _N_COLUMNS * width + 1))
    for i, atom in enumerate(atoms):
        row, column = divmod(i, _N_COLUMNS)
        largest = np.abs(atom).max() or 1.0
        top, first = row * height + 1, column * width + 2
        for eye, part in enumerate((atom / largest).reshape(2, PATCH_SIZE_PX, PATCH_SIZE_PX)):
            start = first + eye * PATCH_SIZE_PX
            mosaic[top : top + PATCH_SIZE_PX, start : start + PATCH_SIZE_PX] = part
    return mosaic
