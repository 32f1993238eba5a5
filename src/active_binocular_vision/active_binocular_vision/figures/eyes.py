"""Both eyes with their twelve muscles, coloured by activation, seen from the front and above.

Drawn with matplotlib along the paths that MuJoCo computes: its renderer would need OpenGL.
"""

from itertools import pairwise

import mujoco
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.patches import Circle, Polygon
from matplotlib.ticker import MaxNLocator

from eye_plant.mechanics.mujoco_model import MechanicsConfig, build_spec
from lockstep import MUSCLE_NAMES, SIDES
from lockstep.command_space import MUSCLES

# The view: orthographic, this far above the horizontal.
_ABOVE_RAD = np.radians(30.0)
# Columns: to the right, up and towards whoever looks; rows: forward, left, up.
_VIEW = np.array(
    [
        [0.0, -np.sin(_ABOVE_RAD), np.cos(_ABOVE_RAD)],
        [1.0, 0.0, 0.0],
        [0.0, np.cos(_ABOVE_RAD), np.sin(_ABOVE_RAD)],
    ]
)
_MM = 1e3
_PIECE_MM = 0.4
# ours, for the eye that looks: thickness of belly, ends and outline; radii of iris and pupil.
_BELLY_MM, _END_MM, _OUTLINE_MM = 3.0, 1.1, 0.5
_IRIS_MM, _PUPIL_MM, _N_RAYS = 5.8, 2.2, 24
# What is farther than the centre of a globe is drawn under it, the rest upon it.
_UNDER, _UPON, _N_JOINED = 0.5, 2.0, 4
COLOURS = LinearSegmentedColormap.from_list("muscle", ["#f6e3d8", "#f0a583", "#d8453a", "#8a0a1c"])
_WHITE, _SHADE = np.array([0.99, 0.985, 0.97]), np.array([0.68, 0.70, 0.74])
_LIMBUS, _IRIS, _RAY, _PUPIL, _LINE = "#2b3f57", "#5b87ab", "#8fb4cf", "#10151d", "0.35"
_LIGHT = np.array([-0.35, 0.55, 0.76])
_N_SHADES_PX = 160


class DrawnEyes:
    """Two eyes in axes, drawn again for each posture."""

    def __init__(self, axes: Axes, config: MechanicsConfig, highest: float) -> None:
        """config: whose eyes; highest: activation of the darkest colour."""
        self.axes = axes
        self._model = build_spec(config).compile()
        self._data = mujoco.MjData(self._model)
        self._radius_mm = _MM * config.parameters.orbit.globe_radius_m
        self.colours = ScalarMappable(Normalize(0.0, highest), COLOURS)
        mujoco.mj_kinematics(self._model, self._data)
        # As far as the centre of the eyes, that of the view.
        self._centre_m = self._data.xpos[self._i_eyes()].mean(axis=0)
        self._moving: list[Polygon | LineCollection] = []
        self._draw_globes()
        axes.set_aspect("equal")
        axes.set_axis_off()
        half_mm = _MM * config.baseline_m / 2.0
        axes.set_xlim(-half_mm - 1.6 * self._radius_mm, half_mm + 1.6 * self._radius_mm)
        axes.set_ylim(-1.8 * self._radius_mm, 2.25 * self._radius_mm)

    def show(self, angles_rad: np.ndarray, activations: np.ndarray) -> None:
        """Draw the eyes at angles (6,), adduction, elevation, intorsion of both."""
        self._data.qpos[:] = angles_rad
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_comPos(self._model, self._data)
        mujoco.mj_tendon(self._model, self._data)
        for artist in self._moving:
            artist.remove()
        self._moving = []
        for i_eye in range(len(SIDES)):
            self._draw_pupil(i_eye)
        paths = [self.path_mm(i) for i in range(len(MUSCLE_NAMES))]
        for i in np.argsort([path[:, 2].mean() for path in paths]):
            self._draw_muscle(i, paths[i], self.colours.to_rgba(activations[i]))

    def describe(self) -> None:
        """Write which eye is which, and what the colours mean."""
        for x, name in ((0.01, "right eye"), (0.99, "left eye")):
            self.axes.text(
                x,
                0.99,
                name,
                transform=self.axes.transAxes,
                ha="left" if x < 0.5 else "right",
                va="top",
            )
        bar = self.axes.inset_axes((0.38, 0.1, 0.24, 0.04))
        bar.set_title("activation")
        self.axes.figure.colorbar(
            self.colours, cax=bar, orientation="horizontal", ticks=MaxNLocator(3)
        )

    def _i_eyes(self) -> list[int]:
        return [self._model.body(f"{side}_eye").id for side in SIDES]

    def _seen_mm(self, points_m: np.ndarray) -> np.ndarray:
        """Return points (n, 3) of the world as they are seen: right, up, towards the viewer."""
        return _MM * (points_m - self._centre_m) @ _VIEW

    def _globe_mm(self, i_eye: int) -> np.ndarray:
        centre: np.ndarray = self._seen_mm(self._data.xpos[self._i_eyes()[i_eye]])
        return centre

    def _draw_globes(self) -> None:
        across = np.linspace(-1.0, 1.0, _N_SHADES_PX)
        right, up = np.meshgrid(across, across)
        front = np.sqrt(np.clip(1.0 - right**2 - up**2, 0.0, None))
        lit = np.clip(np.stack([right, up, front], axis=-1) @ _LIGHT, 0.0, 1.0)[..., None] ** 0.7
        picture = np.clip(_SHADE + (_WHITE - _SHADE) * lit, 0.0, 1.0)
        for i_eye in range(len(SIDES)):
            x, y, _ = self._globe_mm(i_eye)
            r = self._radius_mm
            outline = Circle((x, y), r, fc="none", ec=_LINE, lw=0.8, zorder=1.1)
            self.axes.add_patch(outline)
            self.axes.imshow(
                picture, extent=(x - r, x + r, y - r, y + r), origin="lower", zorder=1
            ).set_clip_path(outline)

    def _draw_pupil(self, i_eye: int) -> None:
        rotation = self._data.xmat[self._i_eyes()[i_eye]].reshape(3, 3)
        turn = np.linspace(0.0, 2.0 * np.pi, 4 * _N_RAYS + 1)
        circle = np.stack([np.zeros_like(turn), np.cos(turn), np.sin(turn)], axis=1)

        def ring(radius_mm: float) -> np.ndarray:
            ahead = np.array([np.sqrt(self._radius_mm**2 - radius_mm**2), 0.0, 0.0])
            seen: np.ndarray = (
                self._globe_mm(i_eye) + (ahead + radius_mm * circle) @ rotation.T @ _VIEW
            )
            return seen[:, :2]

        iris, pupil = ring(_IRIS_MM), ring(_PUPIL_MM)
        rays = np.stack([0.25 * iris + 0.75 * pupil, 0.8 * iris + 0.2 * pupil], axis=1)[::4]
        self._add(Polygon(iris, fc=_IRIS, ec=_LIMBUS, lw=1.2, zorder=1.2))
        self._add(LineCollection(list(rays), colors=_RAY, linewidths=0.5, zorder=1.3))
        self._add(Polygon(pupil, fc=_PUPIL, ec="none", zorder=1.4))

    def _draw_muscle(self, i_muscle: int, path_mm: np.ndarray, colour: np.ndarray) -> None:
        """Draw a path (n, 3) in pieces, thicker in the middle of the muscle."""
        along = np.linspace(0.0, 1.0, len(path_mm))[1:]
        thick_mm = _END_MM + (_BELLY_MM - _END_MM) * np.sin(np.pi * along**0.8) ** 2
        pieces = np.stack([path_mm[:-1, :2], path_mm[1:, :2]], axis=1)
        is_upon = path_mm[1:, 2] >= self._globe_mm(i_muscle // len(MUSCLES))[2]
        # So that no outline crosses the muscle where both parts meet.
        covers = np.convolve(is_upon, np.ones(2 * _N_JOINED + 1), mode="same") > 0
        points_per_mm = self._points_per_mm()
        for zorder, shown, of_piece, more_mm in (
            (_UNDER, ~is_upon, _LINE, _OUTLINE_MM),
            (_UNDER, ~is_upon, colour, 0.0),
            (_UPON, is_upon, _LINE, _OUTLINE_MM),
            (_UPON, covers, colour, 0.0),
        ):
            lines = LineCollection(
                list(pieces[shown]),
                colors=[of_piece],
                linewidths=(thick_mm[shown] + more_mm) * points_per_mm,
                capstyle="round",
                zorder=zorder,
            )
            self._add(lines)

    def path_mm(self, i_muscle: int) -> np.ndarray:
        """Return points (n, 3) of a muscle's path from origin to insertion, as they are seen."""
        data = self._data
        rows = data.ten_wrapadr[i_muscle] + np.arange(data.ten_wrapnum[i_muscle])
        points_m = data.wrap_xpos.reshape(-1, 3)[rows]
        is_on_globe = data.wrap_obj.ravel()[rows] >= 0
        centre_m = data.xpos[self._i_eyes()[i_muscle // len(MUSCLES)]]
        parts_m = [points_m[:1]]
        for i, (begin, end) in enumerate(pairwise(points_m)):
            n = max(1, round(_MM * float(np.linalg.norm(end - begin)) / _PIECE_MM))
            part_m = begin + (end - begin) * np.linspace(0.0, 1.0, n + 1)[1:, None]
            if is_on_globe[i] and is_on_globe[i + 1]:  # MuJoCo gives the ends of the arc
                out_m = part_m - centre_m
                out_m *= np.linalg.norm(begin - centre_m) / np.linalg.norm(out_m, axis=1)[:, None]
                part_m = centre_m + out_m
            parts_m.append(part_m)
        return self._seen_mm(np.concatenate(parts_m))

    def _points_per_mm(self) -> float:
        transform = self.axes.transData.transform
        px = transform((1.0, 0.0))[0] - transform((0.0, 0.0))[0]
        return float(px * 72.0 / self.axes.figure.dpi)

    def _add(self, artist: Polygon | LineCollection) -> None:
        self.axes.add_artist(artist)
        self._moving.append(artist)
