"""The sparse coder's basis functions as left-right pairs, with the disparity that each prefers."""

from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from experiment_manager.analysis.report.performance_figures import new_figure
from lockstep.errors import InputError
from sparse_coder.patches import N_PIXELS, PATCH_SIZE_PX, PX_PER_PIXEL

SCALES = ("coarse", "fine")
_N_COLUMNS = 16
_N_BINS = 37  # odd: one is centred on 0
# Beyond half a patch too little of both eyes' parts overlaps to tell a match from chance.
_LARGEST_SHIFT = 4
# The weaker eye's part of an atom's norm, from 0 (monocular) to 1 (equal).
_LEAST_BALANCE = 0.5


@dataclass(frozen=True)
class Preference:
    """What atoms (n_bases,) prefer.

    balance: norm of the weaker eye's part over that of the stronger; disparity: shift in pixels of
    the scale, positive when the pattern lies farther right in the left eye; match: normalised
    correlation of both parts at that shift, 1 when they are the same.
    """

    balance: np.ndarray
    disparity: np.ndarray
    match: np.ndarray

    @property
    def binocular(self) -> np.ndarray:
        """Which atoms (n_bases,) have a disparity worth telling."""
        both: np.ndarray = (self.balance >= _LEAST_BALANCE) & (self.match >= 0.5)
        return both


def preference(atoms: np.ndarray) -> Preference:
    """Return what each atom (n_bases, 128) prefers: left eye's 8 x 8 pixels, then the right's.

    The preferred disparity is where the cross-correlation along rows of the two parts is largest,
    between pixels by the parabola through the three largest values.
    """
    if atoms.ndim != 2 or atoms.shape[1] != N_PIXELS:
        raise InputError(f"expected atoms (n_bases, {N_PIXELS}), got shape {atoms.shape}")
    left, right = (
        atoms.reshape(-1, 2, PATCH_SIZE_PX, PATCH_SIZE_PX).astype(np.float64).transpose(1, 0, 2, 3)
    )
    norms = np.sqrt(np.stack([(eye**2).sum(axis=(1, 2)) for eye in (left, right)]))
    stronger = np.maximum(norms.max(axis=0), np.finfo(float).tiny)
    shifts = np.arange(-_LARGEST_SHIFT - 1, _LARGEST_SHIFT + 2)
    scale = np.maximum(norms.prod(axis=0), np.finfo(float).tiny)
    correlation = np.stack([_overlap(left, right, int(s)) / scale for s in shifts])
    best = 1 + correlation[1:-1].argmax(axis=0)
    each = np.arange(len(atoms))
    below, peak, above = (correlation[best + step, each] for step in (-1, 0, 1))
    curvature = below - 2.0 * peak + above
    sharp = curvature < -np.finfo(float).eps
    between = np.where(sharp, 0.5 * (below - above) / np.where(sharp, curvature, 1.0), 0.0)
    return Preference(
        balance=norms.min(axis=0) / stronger,
        disparity=shifts[best] + np.clip(between, -0.5, 0.5),
        match=peak,
    )


def _overlap(left: np.ndarray, right: np.ndarray, shift: int) -> np.ndarray:
    """Sum of left(x + shift) right(x) over the pixels that both have: (n_bases,)."""
    n = PATCH_SIZE_PX - abs(shift)
    first = max(shift, 0)
    moved = left[:, :, first : first + n]
    still = right[:, :, first - shift : first - shift + n]
    total: np.ndarray = (moved * still).sum(axis=(1, 2))
    return total


def dictionary_figure(atoms: np.ndarray) -> Figure:
    """Return both dictionaries (2, n_bases, 128), sorted, over their preferred disparities.

    Each tile is an atom, left eye beside right eye, grey at 0, scaled by its largest entry.
    Binocular atoms come first, by preferred disparity; then the others, most balanced first.
    """
    if atoms.ndim != 3 or len(atoms) != len(SCALES):
        raise InputError(f"expected atoms (2, n_bases, {N_PIXELS}), got shape {atoms.shape}")
    figure = new_figure(9.6, 5.6)
    tiles, histograms = figure.subplots(2, 2, height_ratios=(3.6, 1))
    for i, scale in enumerate(SCALES):
        found = preference(atoms[i])
        tiles[i].imshow(_mosaic(atoms[i][_order(found)]), cmap="gray", vmin=-1, vmax=1)
        tiles[i].set_axis_off()
        n_binocular = int(found.binocular.sum())
        tiles[i].set_title(
            f"{scale} scale: {n_binocular} of {len(atoms[i])} prefer a disparity and come first",
            fontsize=9,
        )
        disparity_px = found.disparity[found.binocular] * PX_PER_PIXEL[i]
        reach = (_LARGEST_SHIFT + 0.5) * PX_PER_PIXEL[i]
        histograms[i].hist(disparity_px, bins=np.linspace(-reach, reach, _N_BINS + 1), color="0.35")
        histograms[i].axvline(0.0, color="#d62728", lw=0.8)
        histograms[i].set(xlabel="preferred disparity / px of the picture", xlim=(-reach, reach))
    histograms[0].set_ylabel("basis functions")
    return figure


def _order(found: Preference) -> np.ndarray:
    binocular = found.binocular
    return np.lexsort((np.where(binocular, found.disparity, -found.balance), ~binocular))


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
