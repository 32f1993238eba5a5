"""The frames of a film: both eyes' pictures, their anaglyph, the eyes drawn, errors up to now."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from active_binocular_vision.figures.eyes import DrawnEyes
from active_binocular_vision.figures.style import BLUE, GREY, LIGHT_GREY, VERMILION, own_style
from active_binocular_vision.film.scenes import ERRORS, Scene
from experiment_manager.anaglyph import anaglyph

_DPI = 100
# Three panels side by side: a page shows such a frame as it is, with text of 9 pt.
PANEL_WIDTH_PX, _MOST_HEIGHT_PX = 240, 180
HEADER_PX = 46
_BELOW_PX = 240
_TITLES = ("left eye's image", "right eye's image", "left in red, right in cyan")

_TARGET_COLOUR = tuple(round(255 * part) for part in to_rgb(VERMILION))
_TARGET_RADIUS_PX = 7
_ERROR_STYLES = ((BLUE, "-"), ("black", "--"), (VERMILION, "-."))

# A scene ends with its last frame for a while.
_HELD_PERIODS = 4

Frame = tuple[np.ndarray, int]


def frames(scenes: Sequence[Scene]) -> Iterator[Frame]:
    """Yield per iteration of each scene (height_px, width_px, 3) uint8, RGB, and its periods."""
    with own_style():
        page = Page(scenes)
    for scene in scenes:
        last = len(scene.errors_deg) - 1
        for iteration in range(last + 1):
            with own_style():  # not while whoever takes the frame draws figures of their own
                frame = page.draw(scene, iteration)
            yield frame, _HELD_PERIODS if iteration == last else 1


def shown_part(picture: np.ndarray) -> np.ndarray:
    """Return the middle of a camera's picture (height, width), enlarged to a panel's width."""
    n_times = _times(picture)
    large = picture.repeat(n_times, axis=0).repeat(n_times, axis=1)
    top, left = (
        max(0, (size - most) // 2)
        for size, most in zip(large.shape, (_MOST_HEIGHT_PX, PANEL_WIDTH_PX), strict=True)
    )
    return large[top : top + _MOST_HEIGHT_PX, left : left + PANEL_WIDTH_PX]


def _times(picture: np.ndarray) -> int:
    """Return how many times a camera's picture (height, width) is enlarged."""
    return -(-PANEL_WIDTH_PX // picture.shape[1])


class Page:
    """Header, room for the images, the eyes, and the errors of a scene up to an iteration.

    figure: one for all scenes, drawn again and again.
    """

    def __init__(self, scenes: Sequence[Scene]) -> None:
        """scenes: of one command space; axes have room for all of them."""
        height_px = HEADER_PX + len(shown_part(scenes[0].pictures[0, 0])) + _BELOW_PX
        width_px = len(_TITLES) * PANEL_WIDTH_PX
        self.figure = Figure(figsize=(width_px / _DPI, height_px / _DPI), dpi=_DPI)
        self._canvas = FigureCanvasAgg(self.figure)
        self._caption = self.figure.text(0.01, 1 - 14 / height_px, "", va="center")
        for i, title in enumerate(_TITLES):
            x, y = (i + 0.5) / len(_TITLES), 1 - 35 / height_px
            self.figure.text(x, y, title, ha="center", va="center")
        below = _BELOW_PX / height_px
        eyes = self.figure.add_axes((0.0, 0.0, 2 / 3, below))
        highest = max(float(scene.activations.max()) for scene in scenes)
        self._eyes = DrawnEyes(eyes, scenes[0].mechanics, highest)
        self._eyes.describe()
        self._lines = _error_lines(
            self.figure.add_axes((0.75, 0.2 * below, 0.24, 0.75 * below)), scenes
        )

    def draw(self, scene: Scene, iteration: int) -> np.ndarray:
        """Return the frame (height_px, width_px, 3) uint8."""
        for line, errors_deg in zip(self._lines, scene.errors_deg[: iteration + 1].T, strict=True):
            line.set_data(np.arange(len(errors_deg)), errors_deg)
        self._eyes.show(scene.eye_angles_rad[iteration], scene.activations[iteration])
        self._caption.set_text(
            f"{scene.caption}: {_errors(scene, iteration)},"
            f" metabolic rate {scene.metabolic_rate_w[iteration]:.2f} W"
        )
        self._canvas.draw()
        frame = np.asarray(self._canvas.buffer_rgba())[..., :3].copy()
        left, right = (shown_part(picture) for picture in scene.pictures[iteration])
        eyes = [np.stack([picture] * 3, axis=-1) for picture in (left, right)]
        if scene.targets_deg is not None:
            _mark(eyes[0], scene.targets_deg[iteration], scene)
        frame[HEADER_PX : HEADER_PX + len(left)] = np.hstack([*eyes, anaglyph(left, right)])
        return frame


def _mark(panel: np.ndarray, target_deg: np.ndarray, scene: Scene) -> None:
    """Draw a ring around a gaze target, (2,) to the right and up, in a panel of an eye."""
    angle = np.radians(np.linalg.norm(target_deg))
    aside_px = np.tan(angle) / np.tan(np.radians(scene.px_deg)) * _times(scene.pictures[0, 0])
    right, up = aside_px * np.radians(target_deg) / angle if angle > 0.0 else (0.0, 0.0)
    centre = (round(panel.shape[1] / 2.0 + right), round(panel.shape[0] / 2.0 - up))
    cv2.circle(panel, centre, _TARGET_RADIUS_PX, _TARGET_COLOUR, 2, cv2.LINE_AA)


def _errors(scene: Scene, iteration: int) -> str:
    """Return the errors in the order of their curves' legend."""
    error_deg, *others_deg = scene.errors_deg[iteration]
    if not others_deg:
        return f"vergence error {error_deg:+.2f} deg ({error_deg / scene.px_deg:+.1f} px)"
    values = ", ".join(f"{of_axis:+.2f}" for of_axis in (error_deg, *others_deg))
    return f"errors {values} deg"


def _error_lines(axes: Axes, scenes: Sequence[Scene]) -> list[Line2D]:
    """Return a line for each error, before a band of 1 px to either side."""
    px_deg, n_errors = scenes[0].px_deg, scenes[0].errors_deg.shape[1]
    axes.axhspan(-px_deg, px_deg, color=LIGHT_GREY, alpha=0.6, lw=0)
    lines = [
        axes.plot([], [], marker=".", color=colour, ls=ls, label=name)[0]
        for name, (colour, ls) in zip(ERRORS[:n_errors], _ERROR_STYLES, strict=False)
    ]
    # NaN: the left eye does not look towards the plane.
    limit_deg = 1.1 * max(float(np.nanmax(np.abs(s.errors_deg))) for s in scenes) + px_deg
    axes.set(xlabel="iteration", ylabel="vergence error / deg" if n_errors == 1 else "error / deg")
    axes.set_xlim(-0.3, max(len(scene.errors_deg) for scene in scenes) - 0.7)
    axes.set_ylim(-limit_deg, limit_deg)
    axes.xaxis.set_major_locator(MaxNLocator(4, integer=True))
    corner = axes.transAxes
    axes.text(1.0, 0.0, "grey: ±1 px", transform=corner, ha="right", va="bottom", color=GREY)
    if n_errors > 1:
        axes.legend(loc="upper right", borderaxespad=0.0)
    return lines
