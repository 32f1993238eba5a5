"""The frames of a film: both eyes' pictures, their anaglyph, and curves up to now."""

from collections.abc import Iterator, Sequence

import cv2
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from experiment_manager.anaglyph import anaglyph
from experiment_manager.analysis.film.scenes import MOST_ITERATIONS, Scene
from experiment_manager.analysis.report.performance_figures import PX_DEG

_DPI = 100
_CAPTION_PX = 28
_CURVES_PX = 200
_TITLES = ("left eye", "right eye", "anaglyph")
_WHITE = (255, 255, 255)
_BLACK = (0, 0, 0)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


# A scene ends with its last frame for a while.
_HELD_PERIODS = 4

Frame = tuple[np.ndarray, int]


def frames(scenes: Sequence[Scene]) -> Iterator[Frame]:
    """Yield per iteration of each scene (height_px, width_px, 3) uint8, RGB, and its periods."""
    width_px = 3 * scenes[0].pictures.shape[-1]
    highest = max(float(scene.activations.max()) for scene in scenes)
    widest_deg = max(float(np.abs(scene.error_deg).max()) for scene in scenes)
    curves = _Curves(width_px, highest, widest_deg)
    for scene in scenes:
        last = len(scene.error_deg) - 1
        for iteration in range(last + 1):
            n_periods = _HELD_PERIODS if iteration == last else 1
            yield _picture(scene, iteration, curves), n_periods


def _picture(scene: Scene, iteration: int, curves: "_Curves") -> np.ndarray:
    left, right = scene.pictures[iteration]
    panels = [np.stack([left] * 3, axis=-1), np.stack([right] * 3, axis=-1), anaglyph(left, right)]
    labelled = [_labelled(panel, title) for panel, title in zip(panels, _TITLES, strict=True)]
    error_deg = scene.error_deg[iteration]
    text = (
        f"{scene.caption}, iteration {iteration}: "
        f"vergence error {error_deg:+.2f} deg ({error_deg / PX_DEG:+.1f} px)"
    )
    row = np.hstack(labelled)
    caption = np.full((_CAPTION_PX, row.shape[1], 3), _WHITE, np.uint8)
    cv2.putText(caption, text, (8, 19), _FONT, 0.5, _BLACK, 1, cv2.LINE_AA)
    return np.vstack([caption, row, curves.draw(scene, iteration)])


def _labelled(panel: np.ndarray, title: str) -> np.ndarray:
    shown = np.ascontiguousarray(panel)
    for colour, width in ((_BLACK, 3), (_WHITE, 1)):
        cv2.putText(shown, title, (6, 16), _FONT, 0.45, colour, width, cv2.LINE_AA)
    return shown


class _Curves:
    """Activations and error of a scene up to an iteration; one figure, drawn again and again."""

    def __init__(self, width_px: int, highest: float, widest_deg: float) -> None:
        self._figure = Figure(figsize=(width_px / _DPI, _CURVES_PX / _DPI), dpi=_DPI)
        self._canvas = FigureCanvasAgg(self._figure)
        muscles, error = self._figure.subplots(1, 2)
        self._medial, self._lateral = (
            muscles.plot([], [], marker=".", label=name)[0] for name in ("medial", "lateral rectus")
        )
        muscles.set(xlabel="iteration", ylabel="activation", ylim=(-0.005, 1.3 * highest + 0.005))
        muscles.legend(loc="upper right", fontsize=8, ncols=2)
        error.axhspan(-PX_DEG, PX_DEG, color="0.9", lw=0)
        (self._error,) = error.plot([], [], marker=".", color="C3")
        limit_deg = 1.1 * widest_deg + PX_DEG
        error.set(xlabel="iteration", ylabel="error / deg", ylim=(-limit_deg, limit_deg))
        for axes in (muscles, error):
            axes.set_xlim(-0.3, MOST_ITERATIONS - 0.7)
            axes.tick_params(labelsize=8)
        self._figure.tight_layout()

    def draw(self, scene: Scene, iteration: int) -> np.ndarray:
        """Return the picture (height_px, width_px, 3) uint8."""
        so_far = np.arange(iteration + 1)
        self._medial.set_data(so_far, scene.activations[: iteration + 1, 0])
        self._lateral.set_data(so_far, scene.activations[: iteration + 1, 1])
        self._error.set_data(so_far, scene.error_deg[: iteration + 1])
        self._canvas.draw()
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()
