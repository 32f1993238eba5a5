"""Ask the eyes' mechanics which cost makes antagonists share their work as Sherrington found.

usage: .venv/bin/python sweeps/costs.py OUT [DEG_BETWEEN_GAZES]

Nothing is learned. An eye with anatomical muscles is held at gazes of up to 25 deg about straight
ahead, without torsion in Listing's coordinates. Its six activations have to balance three torques,

    M a + c = 0,  low <= a <= 1,

M: torque per activation, c: torque of passive tissue. Forces are linear in activation at a posture.
Of all activations that do, each cost chooses the cheapest:

    metabolic rate    sum of S A^0.6 h m (Umberger 2003), as in C: concave, so that its least is at
                      a corner with three muscles at their lowest; all corners are tried
    squares           |a|^2
    change            |a - tonic|^2, the least change of the command (Daunicht 1988)
    endpoint variance of the line of sight with noise of each activation in proportion to it
                      (Harris & Wolpert 1998): sum of a_i^2 |(K^-1 m_i)|^2, K: stiffness with a

with a tonic floor, a tension below which no muscle falls, or none. Writes OUT/costs.csv, a row a
cost, OUT/gazes.csv, a row a cost and gaze, and OUT/figures/costs.png.
"""

import csv
import itertools
import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray
from scipy.optimize import minimize

from active_binocular_vision.figures.style import (
    BLUE,
    GREY,
    VERMILION,
    legend_below,
    new_figure,
    own_style,
    save,
    title_panels,
)
from experiment_manager.measures.antagonists import active_pairs, reciprocity
from experiment_manager.measures.tables import number
from experiment_manager.measures.yoked import shared_change
from eye_plant.gaze_error import listing_torsion_deg
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.mechanics.parameters import GRAM_FORCE_N
from lockstep.command_space import MUSCLES

Array = NDArray[np.float64]
Cost = Callable[["Held", Array], float]

MOST_DEG = 25.0
DEG_BETWEEN_GAZES = 5.0
_N, _AXES = len(MUSCLES), slice(0, 3)
_SILENT = 0.005
_PROBE_RAD = 1e-4
# Torques are compared in units of it.
_TORQUE_N_M = 1e-3
_BALANCED_N_M = 1e-8
# Of one eye and of the other; the eyes mirror each other.
_YOKES = (
    ("medial_rectus", "lateral_rectus"),
    ("superior_rectus", "inferior_oblique"),
    ("inferior_rectus", "superior_oblique"),
)


@dataclass(frozen=True)
class Held:
    """The left eye at a posture.

    torque: (3, 6) per activation; passive: (3,); stiffness: (7, 3, 3), without activation and per
    activation; active_n, passive_n: (6,) tensions per activation and without it; lengths_m: (12,).
    """

    torque: Array
    passive: Array
    stiffness: Array
    active_n: Array
    passive_n: Array
    lengths_m: Array
    eyes: Oculomotor

    def lowest(self, floor_gf: float) -> Array:
        """Return the activations (6,) below which tensions fall under a floor."""
        missing_n = floor_gf * GRAM_FORCE_N - self.passive_n
        return np.clip(missing_n / self.active_n, 0.0, 1.0)

    def missed(self, a: Array) -> Array:
        """Return the torque (3,) that activations leave, in units of _TORQUE_N_M."""
        return (self.torque @ a + self.passive) / _TORQUE_N_M

    def tension_gf(self, a: Array) -> Array:
        """Return the pull (6,) of the muscles."""
        return (self.active_n * a + self.passive_n) / GRAM_FORCE_N


class Eye:
    """The left one of two anatomical eyes."""

    def __init__(self) -> None:
        """Build it."""
        self._eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical", moves="at_once"))
        self.tonic = self._eyes.tonic_activations[:_N]

    def held(self, azimuth_deg: float, elevation_deg: float) -> Held:
        """Return the eye held at a gaze (right, up) without torsion in Listing's coordinates."""
        angles = np.radians([azimuth_deg, elevation_deg, 0.0])
        for _ in range(5):
            self._torques(angles, None)
            torsion_deg, _ = listing_torsion_deg(self._eyes.eye_rotations())
            angles[2] -= np.radians(torsion_deg)
        stiffness = np.zeros((_N + 1, 3, 3))
        for axis, aside in enumerate(_PROBE_RAD * np.eye(3)):
            up, down = (self._all_torques(angles + sign * aside) for sign in (1.0, -1.0))
            stiffness[:, :, axis] = -(up - down) / (2.0 * _PROBE_RAD)
        passive, *active = self._all_torques(angles)
        self._torques(angles, None)
        muscles, lengths_m = self._eyes.musculature, self._eyes.data.actuator_length.copy()
        passive_n = muscles.passive_forces_n(lengths_m)[:_N]
        return Held(
            torque=np.array(active).T,
            passive=passive,
            stiffness=stiffness,
            active_n=self._pulls_n(angles) - passive_n,
            passive_n=passive_n,
            lengths_m=lengths_m,
            eyes=self._eyes,
        )

    def _all_torques(self, angles: Array) -> Array:
        """Return torques (7, 3): without activation, and per activation of each muscle."""
        passive = self._torques(angles, None)
        return np.array([passive, *(self._torques(angles, i) - passive for i in range(_N))])

    def _torques(self, angles: Array, i_active: int | None) -> Array:
        data = self._eyes.data
        data.qpos[_AXES], data.qvel[:], data.act[:] = angles, 0.0, 0.0
        if i_active is not None:
            data.act[i_active] = 1.0
        mujoco.mj_forward(self._eyes.model, data)
        return (data.qfrc_passive + data.qfrc_actuator)[_AXES].copy()

    def _pulls_n(self, angles: Array) -> Array:
        """Return the pull (6,) of each muscle at full activation."""
        self._torques(angles, None)
        self._eyes.data.act[:] = 1.0
        mujoco.mj_forward(self._eyes.model, self._eyes.data)
        return -self._eyes.data.actuator_force[:_N]


# Costs


def metabolic_rate_w(held: Held, a: Array) -> float:
    """Return C of one eye."""
    both = np.concatenate([a, a])
    return float(held.eyes.musculature.settled_rate_w(both, held.lengths_m)[:_N].sum())


def squares(_: Held, a: Array) -> float:
    """Return the sum of squared activations."""
    return float(a @ a)


def endpoint_variance(held: Held, a: Array) -> float:
    """Return the variance of the line of sight over that of the noise of a full activation."""
    stiffness = held.stiffness[0] + np.tensordot(a, held.stiffness[1:], axes=1)
    turns = np.linalg.solve(stiffness, held.torque)[:2]
    return float((a**2 * (turns**2).sum(axis=0)).sum())


def corners(held: Held, low: Array) -> Iterator[Array]:
    """Yield the activations that balance with three muscles at their lowest."""
    for free in map(list, itertools.combinations(range(_N), 3)):
        a = low.copy()
        a[free] = 0.0
        torque = held.torque[:, free]
        if abs(np.linalg.det(torque / _TORQUE_N_M)) > 1e-9:
            a[free] = np.linalg.solve(torque, -(held.torque @ a + held.passive))
            if (a >= low - 1e-12).all() and (a <= 1.0).all():
                yield a


def cheapest(held: Held, cost: Cost, low: Array, *, is_concave: bool) -> Array | None:
    """Return the cheapest balanced activations (6,) between low and 1; None where there are none.

    A concave cost is least at a corner; others, which have one valley here, are descended from the
    mean of all corners.
    """
    found = [*corners(held, low)]
    if not found:
        return None
    if is_concave:
        return min(found, key=lambda a: cost(held, a))
    start = np.mean(found, axis=0)
    unit = cost(held, start) or 1.0
    solution = minimize(
        lambda a: cost(held, a) / unit,
        start,
        method="SLSQP",
        bounds=[(least, 1.0) for least in low],
        constraints={"type": "eq", "fun": held.missed, "jac": lambda _: held.torque / _TORQUE_N_M},
        options={"ftol": 1e-12, "maxiter": 300},
    )
    is_balanced = np.abs(held.missed(solution.x)).max() * _TORQUE_N_M < _BALANCED_N_M
    return np.clip(solution.x, low, 1.0) if is_balanced else None


def costs(tonic: Array) -> Mapping[str, tuple[Cost, float, bool]]:
    """Return each cost with its tonic floor in gf, and whether it is concave, by name."""

    def change(_: Held, a: Array) -> float:
        return float((a - tonic) @ (a - tonic))

    return {
        "metabolic rate, A^0.6": (metabolic_rate_w, 0.0, True),
        **{f"A^0.6, floor {gf:g} gf": (metabolic_rate_w, gf, True) for gf in (8.0, 10.0, 12.0)},
        "squares": (squares, 0.0, False),
        "squares, floor 10 gf": (squares, 10.0, False),
        "squares of the change": (change, 0.0, False),
        "endpoint variance": (endpoint_variance, 0.0, False),
        "endpoint variance, floor 10 gf": (endpoint_variance, 10.0, False),
    }


# What they give


def gazes(step_deg: float) -> list[tuple[float, float]]:
    """Return azimuth and elevation of all gazes."""
    n = round(MOST_DEG / step_deg)
    along = [step_deg * i for i in range(-n, n + 1)]
    return [(azimuth, elevation) for elevation in along for azimuth in along]


def measures(places: Array, activations: Array, tensions_gf: Array) -> dict[str, Any]:
    """Return a row of costs.csv; places: (n, 2), activations, tensions_gf: (n, 6), NaN: none."""
    known = np.isfinite(activations).all(axis=1)
    of_pairs = activations.reshape(-1, 3, 2)
    active = active_pairs(of_pairs[known] >= _SILENT)
    assert active is not None
    ahead = (places == 0.0).all(axis=1)
    row: dict[str, Any] = {
        "gazes": int(known.sum()),
        "both active": active.both,
        "one": active.one,
        "none": active.none,
        "active muscles": float(np.median((activations[known] >= _SILENT).sum(axis=1))),
        "medial rectus ahead / gf": float(tensions_gf[ahead, 0][0]),
        "lateral rectus ahead / gf": float(tensions_gf[ahead, 1][0]),
    }
    for name, i_pair, along in (("horizontal recti", 0, 0), ("vertical recti", 1, 1)):
        meridian = known & (places[:, 1 - along] == 0.0)
        for most_deg in (10.0, MOST_DEG):
            near = meridian & (np.abs(places[:, along]) <= most_deg)
            slope = reciprocity(of_pairs[near][:, [i_pair]], _SILENT).slope
            row[f"slope, {name}, {most_deg:g} deg"] = slope
    for yoke in _YOKES:
        row |= yoked(places, activations, *yoke)
    return row


def yoked(places: Array, activations: Array, first: str, second: str) -> dict[str, float]:
    """Return how equal two yoked muscles are over conjugate gazes; the right eye is a mirror."""
    mirrored = {(-x, y): i for i, (x, y) in enumerate(places.tolist())}
    order = [mirrored[x, y] for x, y in places.tolist()]
    both = np.stack(
        [activations[:, MUSCLES.index(first)], activations[order, MUSCLES.index(second)]]
    )
    both = both[:, np.isfinite(both).all(axis=0)]
    change = shared_change(both, np.zeros(both.shape[1]))
    name = f"{first} and {second}".replace("_", " ")
    difference = float(np.median(np.abs(both[0] - both[1])) / max(float(both.mean()), 1e-12))
    return {
        f"correlation, {name}": change.correlation,
        f"slope, {name}": change.slope,
        f"difference over mean, {name}": difference,
    }


def figure_of(places: Array, found: Mapping[str, Array]) -> Figure:
    """Return activations of the horizontal recti over the horizontal meridian, a panel a cost."""
    level = places[:, 1] == 0.0
    figure = new_figure(8.0, 6.6)
    panels = figure.subplots(3, 3, sharex=True, sharey=True)
    for axes, activations in zip(panels.ravel(), found.values(), strict=True):
        for i, colour in ((0, VERMILION), (1, BLUE)):
            axes.plot(places[level, 0], activations[level, i], color=colour, marker="o", ms=3)
        axes.axhline(0.0, color=GREY, lw=0.6)
        axes.axvline(0.0, color=GREY, lw=0.6)
    for axes in panels[-1]:
        axes.set_xlabel("azimuth (nasal) / deg")
    for axes in panels[:, 0]:
        axes.set_ylabel("activation")
    title_panels(panels.ravel(), [*found])
    names = ((VERMILION, "medial rectus"), (BLUE, "lateral rectus"))
    handles = [Line2D([], [], color=c, marker="o", ms=3, label=name) for c, name in names]
    legend_below(figure, handles)
    return figure


def main() -> None:
    """Compute, write and draw."""
    out = Path(sys.argv[1])
    eye, places = Eye(), gazes(float(sys.argv[2]) if len(sys.argv) > 2 else DEG_BETWEEN_GAZES)
    all_held = [eye.held(*place) for place in places]
    at, found, rows = np.array(places), {}, []
    out.mkdir(parents=True, exist_ok=True)
    with (out / "gazes.csv").open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["cost", "azimuth_deg", "elevation_deg", *MUSCLES])
        for name, (cost, floor_gf, is_concave) in costs(eye.tonic).items():
            chosen = [
                cheapest(held, cost, held.lowest(floor_gf), is_concave=is_concave)
                for held in all_held
            ]
            found[name] = np.array([np.full(_N, np.nan) if a is None else a for a in chosen])
            tensions_gf = np.array(
                [held.tension_gf(a) for held, a in zip(all_held, found[name], strict=True)]
            )
            row: dict[str, Any] = {"cost": name}
            rows.append(row | measures(at, found[name], tensions_gf))
            for place, a in zip(places, found[name], strict=True):
                writer.writerow([name, *place, *(f"{value:.6g}" for value in a)])
    with (out / "costs.csv").open("w", newline="") as file:
        of_rows = csv.DictWriter(file, [*rows[0]], lineterminator="\n")
        of_rows.writeheader()
        for row in rows:
            of_rows.writerow({k: number(v) if isinstance(v, float) else v for k, v in row.items()})
    with own_style():
        save(figure_of(at, found), out / "figures" / "costs.png")


if __name__ == "__main__":
    main()
