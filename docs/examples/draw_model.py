"""Draws what the model is: its loop of four nodes (K17 Fig. 1) and the scene that the eyes see.

usage: .venv/bin/python docs/examples/draw_model.py DIR
"""

import math
import sys
from pathlib import Path

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, FancyArrowPatch, FancyBboxPatch, Polygon

from active_binocular_vision.figures.style import (
    BLUE,
    GREEN,
    GREY,
    LIGHT_GREY,
    ORANGE,
    VERMILION,
    WIDTH_IN,
    own_style,
    title_panels,
)
from experiment_manager.protocol import ProtocolConfig
from eye_plant import desired_vergence_deg
from eye_plant.camera.config import CameraConfig
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from sparse_coder.patches import COARSE, FINE

# Of each node: centre and half sizes in units of the drawing, colour, title, what it does.
NODES = {
    "eye_plant": (
        (1.5, 2.3),
        BLUE,
        "two eyes with twelve muscles,\ntwo cameras, a textured plane",
    ),
    "sparse_coder": (
        (5.0, 2.3),
        GREEN,
        "encodes both images together,\nlearns 400 basis functions\nfor each of two scales",
    ),
    "vergence_rl": (
        (8.5, 2.3),
        VERMILION,
        "chooses activations, learns\nwhich of them bring reward",
    ),
    "experiment_manager": ((5.0, 0.35), GREY, "asks for episodes and tests, records, measures"),
}
HALF = {"experiment_manager": (4.7, 0.33)}
BOX = (1.15, 0.72)


def main() -> None:
    """Write loop.svg and scene.svg."""
    directory = Path(sys.argv[1])
    with own_style():
        loop().savefig(directory / "loop.svg")
        scene().savefig(directory / "scene.svg")


def loop() -> Figure:
    """Return the block diagram."""
    figure = Figure(figsize=(WIDTH_IN, 3.7))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set(xlim=(0.0, 10.0), ylim=(-0.1, 4.5))
    axes.set_axis_off()
    for name, (at, colour, text) in NODES.items():
        _box(axes, name, at, colour, text)
    _arrow(axes, (2.65, 2.6), (3.85, 2.6), "left, right\nimage")
    _arrow(axes, (6.15, 2.75), (7.35, 2.75), "features")
    _arrow(axes, (6.15, 2.0), (7.35, 2.0), "reward", below=True)
    _arrow(axes, (2.65, 2.0), (3.85, 2.0), "metabolic\nrate C", below=True)
    _bow(axes, (2.0, 3.02), (8.0, 3.02), 3.45, "muscle activations")
    _bow(
        axes, (9.0, 3.02), (1.0, 3.02), 4.1, "muscle command: an activation for each muscle or pair"
    )
    for x, text in ((1.5, "next episode;\nground truth"), (5.0, ""), (8.5, "")):
        axes.add_patch(_line((x, 0.7), (x, 1.56), "<->", ls="--", color=GREY))
        axes.text(x + 0.1, 1.13, text, va="center", color=GREY, fontsize=8)
    axes.text(
        5.1, 1.13, r"reward $= -(E_{coarse} + E_{fine}) - \lambda\,C$", va="center", fontsize=8.5
    )
    return figure


def _box(axes: Axes, name: str, at: tuple[float, float], colour: str, text: str) -> None:
    x, y = at
    half_x, half_y = HALF.get(name, BOX)
    axes.add_patch(
        FancyBboxPatch(
            (x - half_x, y - half_y),
            2 * half_x,
            2 * half_y,
            boxstyle="round,pad=0,rounding_size=0.12",
            fc=(colour, 0.14),
            ec=colour,
            lw=1.4,
        )
    )
    is_flat = name in HALF
    axes.text(
        x,
        y + (0.12 if is_flat else 0.45),
        name,
        ha="center",
        va="center",
        weight="bold",
        family="monospace",
        fontsize=9,
    )
    axes.text(
        x,
        y - (0.14 if is_flat else 0.16),
        text,
        ha="center",
        va="center",
        fontsize=8,
        linespacing=1.35,
    )


def _line(
    begin: tuple[float, float], end: tuple[float, float], arrows: str, **look: object
) -> FancyArrowPatch:
    return FancyArrowPatch(
        begin, end, arrowstyle=arrows, mutation_scale=11, shrinkA=0, shrinkB=0, **look
    )


def _arrow(
    axes: Axes,
    begin: tuple[float, float],
    end: tuple[float, float],
    text: str,
    *,
    below: bool = False,
) -> None:
    axes.add_patch(_line(begin, end, "-|>", color="black"))
    x, y = (begin[0] + end[0]) / 2, begin[1] + (-0.07 if below else 0.07)
    axes.text(x, y, text, ha="center", va="top" if below else "bottom", fontsize=8)


def _bow(
    axes: Axes, begin: tuple[float, float], end: tuple[float, float], height: float, text: str
) -> None:
    """Draw an arrow that leaves a box upwards, goes across and enters another one."""
    axes.plot(
        [begin[0], begin[0], end[0], end[0]], [begin[1], height, height, end[1] + 0.15], "k", lw=1
    )
    axes.add_patch(_line((end[0], end[1] + 0.2), end, "-|>", color="black"))
    axes.text((begin[0] + end[0]) / 2, height + 0.05, text, ha="center", va="bottom", fontsize=8)


def scene() -> Figure:
    """Return the scene from above, to scale, and what a vergence error is, not to scale."""
    figure = Figure(figsize=(WIDTH_IN, 3.6), layout="constrained")
    above, error = figure.subplots(1, 2, width_ratios=(1.75, 1.0))
    _draw_above(above)
    _draw_error(error)
    title_panels((above, error), ("the scene from above, to scale", "vergence error, not to scale"))
    return figure


def _draw_above(axes: Axes) -> None:
    camera, mechanics, protocol = CameraConfig(), MechanicsConfig(), ProtocolConfig()
    reach_m = 7.2
    for width_px, colour, name in (
        (camera.width_px, LIGHT_GREY, "image"),
        (COARSE.window_px, BLUE, "coarse window"),
        (FINE.window_px, ORANGE, "fine window"),
    ):
        half = width_px / 2.0 / camera.focal_length_px
        degrees = 2.0 * math.degrees(math.atan(half))
        corners = [(0.0, 0.0), (reach_m, half * reach_m), (reach_m, -half * reach_m)]
        axes.add_patch(
            Polygon(corners, color=colour, alpha=0.45, lw=0, label=f"{name}, {degrees:.0f} deg")
        )
    for distance_m in protocol.test_distances_m:
        half_m = camera.plane_size_m / 2.0
        axes.plot(
            [distance_m] * 2, [-half_m, half_m], color="0.3", lw=2.5 if distance_m == 2.0 else 0.8
        )
        gamma = desired_vergence_deg(distance_m, mechanics.baseline_m)
        axes.text(distance_m, -half_m - 0.08, f"{gamma:.1f}", ha="center", va="top", fontsize=8)
    axes.text(
        2.9,
        -camera.plane_size_m / 2.0 - 0.45,
        "vergence that fixates the plane / deg",
        ha="center",
        va="top",
        fontsize=8,
    )
    axes.annotate(
        f"plane, {camera.plane_size_m:g} m x {camera.plane_size_m:g} m,\nat one of these distances",
        (2.0, 1.45),
        (2.4, 2.05),
        fontsize=8,
        arrowprops={"arrowstyle": "-", "color": GREY},
    )
    axes.text(
        reach_m,
        -2.5,
        f"landscape,\n{camera.landscape_distance_m:g} m away",
        ha="right",
        fontsize=8,
    )
    axes.plot(0.0, 0.0, "o", ms=5, color="black")
    axes.annotate(
        f"eyes, {1e3 * mechanics.baseline_m:g} mm apart,\n{mechanics.eye_height_m:g} m high",
        (0.0, 0.0),
        (-0.25, 1.6),
        fontsize=8,
        arrowprops={"arrowstyle": "-", "color": GREY},
    )
    axes.set(
        xlim=(-0.4, reach_m),
        ylim=(-2.6, 2.6),
        xlabel="distance from the eyes / m",
        ylabel="to the left / m",
        aspect="equal",
    )
    axes.set_xticks([0.5, 1, 2, 3, 4, 5, 6], ["0.5", "1", "2", "3", "4", "5", "6"])
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=3, columnspacing=1.0)


def _draw_error(axes: Axes) -> None:
    axes.set(xlim=(-1.6, 1.6), ylim=(-0.85, 4.0), aspect="equal")
    axes.set_axis_off()
    plane, crossing = 3.6, 2.5
    axes.plot([-1.4, 1.4], [plane, plane], color="0.3", lw=2.5)
    axes.text(1.4, plane + 0.1, "plane", ha="right", va="bottom", fontsize=8)
    for x in (-0.8, 0.8):
        beyond = -x * (plane - crossing) / crossing
        axes.plot([x, beyond], [0.0, plane], color=VERMILION)
        axes.plot([x, 0.0], [0.0, plane], color=BLUE, ls="--")
        axes.add_patch(Circle((x, 0.0), 0.22, fc="white", ec="black", zorder=3))
    angle = math.degrees(math.atan(0.8 / crossing))
    wanted = math.degrees(math.atan(0.8 / plane))
    axes.add_patch(
        Arc((0.0, crossing), 1.3, 1.3, theta1=270 - angle, theta2=270 + angle, color=VERMILION)
    )
    axes.add_patch(
        Arc((0.0, plane), 1.5, 1.5, theta1=270 - wanted, theta2=270 + wanted, color=BLUE)
    )
    axes.text(
        -0.4, crossing - 0.45, "vergence", ha="right", va="center", color=VERMILION, fontsize=8
    )
    axes.text(
        0.35,
        plane - 0.62,
        "desired vergence\n= 2 atan(b / 2d)",
        ha="left",
        va="center",
        color=BLUE,
        fontsize=8,
    )
    axes.annotate("", (-0.8, -0.62), (0.8, -0.62), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    axes.text(0.0, -0.66, "baseline b", ha="center", va="top", fontsize=8)
    axes.annotate("", (-1.35, 0.0), (-1.35, plane), arrowprops={"arrowstyle": "<->", "lw": 0.8})
    axes.text(-1.42, plane / 2.0, "distance d", ha="right", va="center", rotation=90, fontsize=8)
    for x, name in ((-0.8, "left eye"), (0.8, "right eye")):
        axes.text(x, -0.28, name, ha="center", va="top", fontsize=8)


if __name__ == "__main__":
    main()
