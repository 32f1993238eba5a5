"""The frames of a film: both eyes' pictures, their anaglyph, and curves up to now."""

from collections.abc import Iterator, Sequence
from typing import Any

import cv2
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from experiment_manager.anaglyph import anaglyph
from experiment_manager.analysis.film.scenes import ERRORS, MOST_ITERATIONS, Scene
from lockstep.command_space import MUSCLES, SIDES

_DPI = 100
_CAPTION_PX = 28
_CURVES_PX = 200
# Of more muscles than the pair's, with a line that names them.
_MANY_CURVES_PX, _MANY_CURVES_WIDTH_PX = 290, 960
_LEGEND_PX = 28
_TITLES = ("left eye", "right eye", "anaglyph")
_WHITE = (255, 255, 255)
_BLACK = (0, 0, 0)
_FONT = cv2.FONT_HERSHEY_SIMPLEX


_PAIR_LABELS = ("medial", "lateral rectus")
# Antagonists share colour and marker; the second of them is dashed. The few colours of a GIF keep
# these apart.
_MUSCLE_COLOURS, _MUSCLE_MARKERS = ("black", "#d55e00", "#0072b2"), "os^"
_MUSCLE_STYLES: tuple[dict[str, Any], ...] = ({"ls": "-"}, {"ls": "--", "mfc": "white"})
_ERROR_STYLES = (("C3", "-"), ("black", "--"), ("#56b4e9", "-."))

# A scene ends with its last frame for a while.
_HELD_PERIODS = 4

Frame = tuple[np.ndarray, int]


def frames(scenes: Sequence[Scene]) -> Iterator[Frame]:
    """Yield per iteration of each scene (height_px, width_px, 3) uint8, RGB, and its periods."""
    width_px = len(_TITLES) * scenes[0].pictures.shape[-1]
    # Curves of many muscles need room; pictures grow with it.
    n_times = 1 if _is_of_pair(scenes[0]) else -(-_MANY_CURVES_WIDTH_PX // width_px)
    curves = Curves(n_times * width_px, scenes)
    for scene in scenes:
        last = len(scene.errors_deg) - 1
        for iteration in range(last + 1):
            n_periods = _HELD_PERIODS if iteration == last else 1
            yield _picture(scene, iteration, n_times, curves), n_periods


def _is_of_pair(scene: Scene) -> bool:
    return scene.errors_deg.shape[1] == 1


def _picture(scene: Scene, iteration: int, n_times: int, curves: "Curves") -> np.ndarray:
    """Return a frame with pictures that are n_times as wide and high as the cameras'."""
    left, right = scene.pictures[iteration].repeat(n_times, axis=1).repeat(n_times, axis=2)
    panels = [np.stack([left] * 3, axis=-1), np.stack([right] * 3, axis=-1), anaglyph(left, right)]
    labelled = [_labelled(panel, title) for panel, title in zip(panels, _TITLES, strict=True)]
    text = f"{scene.caption}, iteration {iteration}: {_errors(scene, iteration)}"
    row = np.hstack(labelled)
    caption = np.full((_CAPTION_PX, row.shape[1], 3), _WHITE, np.uint8)
    cv2.putText(caption, text, (8, 19), _FONT, 0.5, _BLACK, 1, cv2.LINE_AA)
    return np.vstack([caption, row, curves.draw(scene, iteration)])


def _errors(scene: Scene, iteration: int) -> str:
    error_deg, *others_deg = scene.errors_deg[iteration]
    if not others_deg:
        return f"vergence error {error_deg:+.2f} deg ({error_deg / scene.px_deg:+.1f} px)"
    named = zip(ERRORS, (error_deg, *others_deg), strict=True)
    return "errors " + ", ".join(f"{name} {of_name:+.2f} deg" for name, of_name in named)


def _labelled(panel: np.ndarray, title: str) -> np.ndarray:
    shown = np.ascontiguousarray(panel)
    for colour, width in ((_BLACK, 3), (_WHITE, 1)):
        cv2.putText(shown, title, (6, 16), _FONT, 0.45, colour, width, cv2.LINE_AA)
    return shown


class Curves:
    """Activations and errors of a scene up to an iteration.

    figure: one for all scenes, drawn again and again.
    """

    def __init__(self, width_px: int, scenes: Sequence[Scene]) -> None:
        """scenes: of one command space; axes have room for all of them."""
        is_of_pair = _is_of_pair(scenes[0])
        height_px = _CURVES_PX if is_of_pair else _MANY_CURVES_PX
        self.figure = Figure(figsize=(width_px / _DPI, height_px / _DPI), dpi=_DPI)
        self._canvas = FigureCanvasAgg(self.figure)
        *muscles, error = self.figure.subplots(1, 2 if is_of_pair else 1 + len(SIDES))
        highest = max(float(scene.activations.max()) for scene in scenes)
        draw = _pair_lines if is_of_pair else _muscle_lines
        self._activations = draw(muscles, scenes[0].names, highest)
        self._errors = _error_lines(error, scenes)
        for axes in (*muscles, error):
            axes.set_xlim(-0.3, MOST_ITERATIONS - 0.7)
            axes.set_xlabel("iteration")
            axes.tick_params(labelsize=8)
        below = 0.0 if is_of_pair else _LEGEND_PX / height_px
        self.figure.tight_layout(rect=(0.0, below, 1.0, 1.0))

    def draw(self, scene: Scene, iteration: int) -> np.ndarray:
        """Return the picture (height_px, width_px, 3) uint8."""
        lines = [*self._activations, *self._errors]
        values = np.hstack([scene.activations, scene.errors_deg])[: iteration + 1]
        for line, of_line in zip(lines, values.T, strict=True):
            line.set_data(np.arange(len(values)), of_line)
        self._canvas.draw()
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()


def _pair_lines(panels: Sequence[Axes], names: Sequence[str], highest: float) -> list[Line2D]:
    """Return the lines of both activations of the pair, in the only one of the panels."""
    (axes,) = panels
    lines = [
        axes.plot([], [], marker=".", label=label)[0]
        for _, label in zip(names, _PAIR_LABELS, strict=True)
    ]
    axes.set(ylabel="activation", ylim=(-0.005, 1.3 * highest + 0.005))
    axes.legend(loc="upper right", fontsize=8, ncols=2)
    return lines


def _muscle_lines(panels: Sequence[Axes], names: Sequence[str], highest: float) -> list[Line2D]:
    """Return a line for each muscle, in the panel of its eye; a legend names them for both."""
    lines = []
    for name in names:
        side, _, muscle = name.partition("_")
        i_pair, i_antagonist = divmod(MUSCLES.index(muscle), 2)
        style = {
            "label": muscle.replace("_", " "),
            "color": _MUSCLE_COLOURS[i_pair],
            "marker": _MUSCLE_MARKERS[i_pair],
            "ms": 3,
            **_MUSCLE_STYLES[i_antagonist],
        }
        axes = panels[SIDES.index(side)]
        lines += axes.plot([], [], **style)
    for axes, side in zip(panels, SIDES, strict=True):
        axes.set(ylabel=f"activation, {side} eye", ylim=(-0.005, 1.05 * highest + 0.005))
    shown = panels[0].get_lines()
    figure = panels[0].figure
    figure.legend(handles=shown, loc="lower center", fontsize=8, ncols=len(shown), frameon=False)
    return lines


def _error_lines(axes: Axes, scenes: Sequence[Scene]) -> list[Line2D]:
    """Return a line for each error; a legend names them where there is more than one."""
    px_deg, n_errors = scenes[0].px_deg, scenes[0].errors_deg.shape[1]
    axes.axhspan(-px_deg, px_deg, color="0.9", lw=0)
    lines = [
        axes.plot([], [], marker=".", color=colour, ls=ls, label=name)[0]
        for name, (colour, ls) in zip(ERRORS[:n_errors], _ERROR_STYLES, strict=False)
    ]
    # NaN: the left eye does not look towards the plane.
    limit_deg = 1.1 * max(float(np.nanmax(np.abs(s.errors_deg))) for s in scenes) + px_deg
    axes.set(ylabel="error / deg", ylim=(-limit_deg, limit_deg))
    if n_errors > 1:
        place = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}
        axes.legend(fontsize=8, ncols=n_errors, frameon=False, **place)
    return lines
