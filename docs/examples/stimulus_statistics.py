"""Spectrum, contrast and orientations of stimuli: the numbers of docs/model/stimuli.md.

.venv/bin/python docs/examples/stimulus_statistics.py                       # the generated ones
.venv/bin/python docs/examples/stimulus_statistics.py --directory DIR       # images of your own
.venv/bin/python docs/examples/stimulus_statistics.py --figure stimuli.png  # three, and spectra
"""

import argparse

import cv2
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from eye_plant import load_stimuli
from eye_plant.stimuli.stimulus_set import StimuliConfig

Floats = NDArray[np.float64]

# Of a stimulus reduced to this side; slopes are fitted between these cycles per stimulus.
SIDE_PX, FITTED = 480, (4.0, 120.0)


def amplitude(stimulus: NDArray[np.uint8]) -> Floats:
    """Return the Fourier amplitude (side, side) of a windowed stimulus of mean 0 and SD 1."""
    small = cv2.resize(stimulus, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA).astype(float)
    window = cv2.createHanningWindow((SIDE_PX, SIDE_PX), cv2.CV_64F)
    return np.abs(np.fft.fftshift(np.fft.fft2(window * (small - small.mean()) / small.std())))


def main() -> None:
    """Print slope, contrast and the share of upright contours; draw if asked."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--directory", default="", help="images; empty: the generated stimuli")
    parser.add_argument("--figure", default="", help="PNG to draw")
    arguments = parser.parse_args()
    stimuli = load_stimuli(StimuliConfig(directory=arguments.directory)).all
    axis = np.arange(SIDE_PX) - SIDE_PX // 2
    column, row = np.meshgrid(axis, axis)
    cycles, angle_deg = np.hypot(column, row), np.degrees(np.arctan2(row, column)) % 180.0
    is_fitted = (cycles >= FITTED[0]) & (cycles <= FITTED[1])
    ring = np.rint(cycles).astype(int)
    n_of_rings = np.maximum(np.bincount(ring[is_fitted]), 1)
    spectra, upright = [], []
    for stimulus in stimuli:
        a = amplitude(stimulus)
        spectra.append(np.bincount(ring[is_fitted], a[is_fitted]) / n_of_rings)
        is_upright = np.minimum(angle_deg % 90.0, 90.0 - angle_deg % 90.0) < 11.25
        power = a[is_fitted] ** 2 * cycles[is_fitted]  # as if the spectrum were flat
        upright.append(power[is_upright[is_fitted]].sum() / power.sum())
    at = np.arange(int(FITTED[0]), int(FITTED[1]) + 1)
    slopes = [np.polyfit(np.log(at), np.log(s[at]), 1)[0] for s in spectra]
    contrasts = [s.std() / s.mean() for s in stimuli]
    print(f"{len(stimuli)} stimuli, mean +- SD over them:")
    print(f"amplitude falls as f^{np.mean(slopes):.2f} +- {np.std(slopes):.2f}")
    print(f"RMS contrast {np.mean(contrasts):.2f} +- {np.std(contrasts):.2f}")
    print(
        f"contours within 11.25 deg of upright or level {100 * np.mean(upright):.0f} % (even: 25)"
    )
    if arguments.figure:
        figure = Figure(figsize=(10.0, 2.6), layout="constrained")
        axes = figure.subplots(1, 4)
        for panel, stimulus in zip(axes[:3], stimuli, strict=False):
            panel.imshow(
                cv2.resize(stimulus, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA),
                cmap="gray",
                vmin=0,
                vmax=255,
            )
            panel.set_axis_off()
        lower, median, upper = np.quantile([s[at] for s in spectra], (0.05, 0.5, 0.95), axis=0)
        axes[3].fill_between(at, lower, upper, color="0.8", label="5 to 95 %")
        axes[3].loglog(at, median, color="k", label=f"median of {len(stimuli)}")
        axes[3].loglog(at, median[8] * at[8] / at, color="C3", linestyle=":", label="1/f")
        axes[3].set_xlabel("cycles per stimulus")
        axes[3].set_ylabel("amplitude")
        axes[3].legend(fontsize=8)
        figure.savefig(arguments.figure, dpi=120)


if __name__ == "__main__":
    main()
