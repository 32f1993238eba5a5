"""What is published about real eyes and about OpenEyeSim's, and the same of the simulated ones."""

import math
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.optimize import root

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.defocus import STEP_PX, disc_diameter_px, disc_kernel
from eye_plant.inverse.pair import Inverse
from eye_plant.lens.config import LensesConfig
from eye_plant.lens.lenses import Lenses, ciliary_activation
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.mechanics.parameters import GRAM_FORCE_N
from eye_plant.validation import MAPS_VARIABLE
from eye_plant.validation.saccades import PULSES, Saccade, holding_pair, make_saccade
from eye_plant.vergence import desired_vergence_deg
from lockstep.command_space import INTRAOCULAR_NAMES, MUSCLES

Array = NDArray[np.float64]

# Medial and lateral activations at which OpenEyeSim's maps and our eyes are compared.
GRID = np.linspace(0.0, 1.0, 11)
K17 = MechanicsConfig(parameter_set="k17")
ANATOMICAL = MechanicsConfig(parameter_set="anatomical")

# Object distance in m, and the one activation (medial, lateral) that verges on it.
SINGLE_MUSCLE_POINTS: tuple[tuple[float, float, float], ...] = (
    (0.5, 0.0736, 0.0),
    (1.0, 0.0315, 0.0),
    (2.0, 0.0089, 0.0),
    (4.0, 0.0, 0.0027),
    (6.0, 0.0, 0.0064),
)
# Signs of adduction, elevation, intorsion that each muscle gives an eye looking straight ahead;
# 0 where anatomy names no action.
ACTIONS = {
    "medial_rectus": (1, 0, 0),
    "lateral_rectus": (-1, 0, 0),
    "superior_rectus": (1, 1, 1),
    "inferior_rectus": (1, -1, -1),
    "superior_oblique": (-1, -1, 1),
    "inferior_oblique": (-1, 1, -1),
}
# As much as gaze of 20 deg or so takes; none of the tonic levels is lower.
_PROBE = 0.07
# Velocity stops rising once the pulse cannot grow: less than this counts as level.
_LEVEL_DEG_S = 2.0

_MAPS = "OpenEyeSim (Priamikov et al. 2016)"
_ACTIONS = "Leigh & Zee 2015"
_TENSIONS = "Collins et al. 1981"
_DURATION = "Carpenter 1988"
_VELOCITY = "Bahill, Clark & Stark 1975"
_AMPLITUDE = "Hofstetter 1950"


@dataclass(frozen=True)
class Check:
    """A published value, and how the same is measured of the simulated eyes.

    bound: lowest and highest value, in unit; measure: returns the value in unit, nan where it needs
    OpenEyeSim's maps and they are absent.
    """

    name: str
    source: str
    unit: str
    bound: tuple[float, float]
    measure: Callable[[], float]

    def row(self) -> dict[str, Any]:
        """Measure, and return the entry of plant_validation.json; value and ok None for nan."""
        low, high = self.bound
        value = float(self.measure())
        is_measured = not math.isnan(value)
        return {
            "name": self.name,
            "value": value if is_measured else None,
            "unit": self.unit,
            "bound": f"{low:g} to {high:g}" if low > 0.0 else f"at most {high:g}",
            "ok": low <= value <= high if is_measured else None,
        }


CHECKS: list[Check] = []


def _check(
    name: str, source: str, unit: str, bound: tuple[float, float], *arguments: Any
) -> Callable[[Callable[..., float]], Callable[..., float]]:
    """Enter a function into CHECKS, to be called with these arguments; fields as Check has them."""

    def enter(measure: Callable[..., float]) -> Callable[..., float]:
        CHECKS.append(Check(name, source, unit, bound, partial(measure, *arguments)))
        return measure

    return enter


def usual_duration_ms(amplitude_deg: float | Array) -> Any:
    """Duration of a saccade, 2.2 A + 21 ms (Carpenter 1988)."""
    return 2.2 * amplitude_deg + 21.0


@cache
def saccades() -> dict[float, Saccade]:
    """Return the anatomical eyes' saccades by amplitude in deg."""
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical", timestep_s=1e-3))
    return {
        amplitude_deg: make_saccade(eyes, holding_pair(eyes, amplitude_deg), command)
        for amplitude_deg, command in PULSES.items()
    }


def openeyesim_maps() -> tuple[Array, Array] | None:
    """Return OpenEyeSim's adduction in deg and cost of one eye in W, (11, 11) each; None if absent.

    Rows are medial, columns lateral activations 0, 0.1, ..., 1. The maps are not ours to ship: the
    environment variable ABV_OPENEYESIM_MAPS names a CSV file with one line of titles and 121 of
    medial activation, lateral activation, adduction, cost. Raises OSError or ValueError for others.
    """
    if not (path := os.environ.get(MAPS_VARIABLE)):
        return None
    rows = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(0, 1, 2, 3), ndmin=2)
    rows = rows[np.lexsort((rows[:, 1], rows[:, 0]))]
    medial, lateral, adduction, cost = rows.T.reshape(4, 11, 11)
    if not (np.allclose(medial, GRID[:, None]) and np.allclose(lateral, GRID)):
        raise ValueError("expected each pair of the activations 0, 0.1, ..., 1 once")
    return adduction, cost


def adduction_deg(medial: Array, lateral: Array) -> Array:
    """Adduction (n, m) of a k17 eye at rest, for medial (n,) and lateral (m,) activations."""
    inverse = Inverse(K17)
    return np.array([[0.5 * inverse.vergence_deg(m, lat) for lat in lateral] for m in medial])


@_check("k17: gaze map, all activations, rms", _MAPS, "deg", (0.0, 2.0), 1.0, 1.0)
@_check("k17: gaze map, within K17's limits, rms", _MAPS, "deg", (0.0, 0.15), 0.2, 0.1)
def _gaze_error_deg(highest_medial: float, highest_lateral: float) -> float:
    """Rms difference from the spline of OpenEyeSim's map, between 0 and the highest activations."""
    if (maps := openeyesim_maps()) is None:
        return math.nan
    medial, lateral = GRID * highest_medial, GRID * highest_lateral
    between = CubicSpline(GRID, CubicSpline(GRID, maps[0], axis=1)(lateral), axis=0)(medial)
    return _rms(adduction_deg(medial, lateral) - between)


def cost_w(medial: Array, lateral: Array) -> Array:
    """Metabolic rate (n, m) of a k17 eye at rest, for medial (n,) and lateral (m,) activations."""
    eyes = Oculomotor(K17)

    def of_one_eye(m: float, lat: float) -> float:
        eyes.settle(eyes.activations_from(m, lat))
        return 0.5 * eyes.horizontal_metabolic_rate_w()

    return np.array([[of_one_eye(m, lat) for lat in lateral] for m in medial])


def power_law_w(medial: Array, lateral: Array) -> Array:
    """Cost (n, m) by a power law that meets OpenEyeSim's map to 6 mW rms at its grid points."""
    of_medial, of_lateral = (np.maximum(a, 0.005) ** 0.6 for a in (medial, lateral))
    return np.add.outer(2.229 * of_medial, 2.030 * of_lateral)


@_check("k17: cost at six grid points, rms", _MAPS, "%", (0.0, 3.0))
def _map_cost_error_percent() -> float:
    """Rms difference from OpenEyeSim's cost at the six grid points within K17's limits."""
    if (maps := openeyesim_maps()) is None:
        return math.nan
    return 100.0 * _rms(cost_w(GRID[:3], GRID[:2]) / maps[1][:3, :2] - 1.0)


@_check("k17: cost against the power law, worst", _MAPS, "%", (0.0, 1.0))
def _law_cost_error_percent() -> float:
    medial, lateral = np.linspace(0.0, 0.2, 9), np.linspace(0.0, 0.1, 9)
    return 100.0 * np.abs(cost_w(medial, lateral) / power_law_w(medial, lateral) - 1.0).max()


@_check("k17: single-muscle points, worst", _MAPS, "activation", (0.0, 0.003))
def _single_muscle_error() -> float:
    inverse, errors = Inverse(K17), []
    for distance_m, medial, lateral in SINGLE_MUSCLE_POINTS:
        best = inverse.optimal(desired_vergence_deg(distance_m, K17.baseline_m))
        errors += [abs(best.medial - medial), abs(best.lateral - lateral)]
    return max(errors)


def pulling_directions(config: MechanicsConfig) -> Array:
    """Torque per unit of force of the left eye's muscles, (6, 3) in mm, looking straight ahead."""
    eyes = Oculomotor(config)
    eyes.data.qpos[:] = 0.0
    mujoco.mj_forward(eyes.model, eyes.data)
    moment_m = np.zeros((eyes.model.nu, eyes.model.nv))
    mujoco.mju_sparse2dense(
        moment_m,
        eyes.data.actuator_moment.reshape(-1),
        eyes.data.moment_rownnz,
        eyes.data.moment_rowadr,
        eyes.data.moment_colind.reshape(-1),
    )
    # A muscle pulls: its force shortens the path, against the moment's sign.
    return -1e3 * moment_m[: len(MUSCLES), :3]


@_check("anatomical: wrong pulling directions", _ACTIONS, "", (0.0, 0.0), ANATOMICAL)
@_check("k17: wrong pulling directions", _ACTIONS, "", (0.0, 0.0), K17)
def _count_wrong_directions(config: MechanicsConfig) -> float:
    """Count anatomical actions below 5 % of their muscle's greatest, and other ones above 2 %."""
    directions = pulling_directions(config)
    shares = directions / np.abs(directions).max(axis=1, keepdims=True)
    signs = np.array([ACTIONS[muscle] for muscle in MUSCLES])
    is_right = np.where(signs == 0, np.abs(shares) < 0.02, shares * signs > 0.05)
    return float(np.count_nonzero(~is_right))


@_check("anatomical: lateral rectus, 45 deg abducted", _TENSIONS, "gf", (30.0, 50.0), 1, -45.0)
@_check("anatomical: medial rectus, 45 deg adducted", _TENSIONS, "gf", (30.0, 50.0), 0, 45.0)
@_check("anatomical: lateral rectus, straight ahead", _TENSIONS, "gf", (8.0, 15.0), 1)
@_check("anatomical: medial rectus, straight ahead", _TENSIONS, "gf", (8.0, 15.0), 0)
def _tension_gf(i_muscle: int, adduction_deg: float | None = None) -> float:
    """Tension of a muscle of an eye that is held at an adduction, at tonic level without one."""
    eyes = Oculomotor(ANATOMICAL)
    if adduction_deg is not None:
        holding_pair(eyes, adduction_deg)
    return eyes.state().forces_n[i_muscle] / GRAM_FORCE_N


@_check("anatomical: torsion in secondary gaze", "ours: 4 x that of real eyes", "deg", (0.0, 1.0))
def _worst_torsion_deg() -> float:
    """Greatest torsion at 15 and 30 deg in, out, up and down.

    Gaze takes one fixed innervation pattern for each direction: the smallest change of the six
    tonic levels that turns the eye there without torsion, judged by how it turns when one muscle's
    activation rises and falls by 0.07. So torsion away from the primary position is the plant's.
    """
    eyes = Oculomotor(ANATOMICAL)
    tonic = eyes.tonic_activations[: len(MUSCLES)]

    def gaze_deg(activations: Array) -> Array:
        eyes.settle(np.tile(np.clip(activations, 0.0, 1.0), 2))
        return np.degrees(eyes.state().eye_angles_rad[0])

    probes = _PROBE * np.eye(len(MUSCLES))
    rises_deg = [gaze_deg(tonic + probe) - gaze_deg(tonic - probe) for probe in probes]
    patterns = np.linalg.pinv(np.transpose(rises_deg) / (2.0 * _PROBE))[:, :2].T
    torsions_deg = []
    for wanted_deg in (np.outer((-30.0, -15.0, 15.0, 30.0), e) for e in np.eye(2)):
        for wanted in wanted_deg:
            found = root(lambda d, w=wanted: gaze_deg(tonic + d @ patterns)[:2] - w, wanted)
            torsions_deg.append(abs(gaze_deg(tonic + found.x @ patterns)[2]))
    return max(torsions_deg)


@_check("anatomical: duration of saccades, worst", _DURATION, "%", (0.0, 25.0))
def _worst_duration_error_percent() -> float:
    return 100.0 * max(
        abs(saccade.duration_ms / usual_duration_ms(amplitude_deg) - 1.0)
        for amplitude_deg, saccade in saccades().items()
    )


@_check("anatomical: amplitude of saccades, worst", "ours: as commanded", "%", (0.0, 5.0))
def _worst_amplitude_error_percent() -> float:
    return 100.0 * max(
        abs(saccade.amplitude_deg / amplitude_deg - 1.0)
        for amplitude_deg, saccade in saccades().items()
    )


@_check("anatomical: peak velocity of 10 deg", _VELOCITY, "deg/s", (300.0, 450.0))
def _peak_velocity_deg_s() -> float:
    return saccades()[10.0].peak_velocity_deg_s


def _peaks_deg_s() -> Array:
    return np.array([saccade.peak_velocity_deg_s for saccade in saccades().values()])


@_check("anatomical: greatest peak velocity", _VELOCITY, "deg/s", (0.0, 900.0))
def _greatest_peak_velocity_deg_s() -> float:
    return _peaks_deg_s().max()


@_check("anatomical: falls of peak velocity with amplitude", _VELOCITY, "", (0.0, 0.0))
def _falls_of_peak_velocity() -> float:
    return float(np.count_nonzero(np.diff(_peaks_deg_s()) < -_LEVEL_DEG_S))


@_check("anatomical: last rise of peak velocity over the first", _VELOCITY, "", (-math.inf, 0.5))
def _last_rise_over_first() -> float:
    rises_deg_s = np.diff(_peaks_deg_s())
    return rises_deg_s[-1] / rises_deg_s[0]


@_check("lens: range at 20 years", _AMPLITUDE, "D", (10.0, 17.0), 20.0)
@_check("lens: range at 45 years", _AMPLITUDE, "D", (3.75, 7.0), 45.0)
@_check("lens: range at 60 years", _AMPLITUDE, "D", (0.0, 1.0), 60.0)
def _range_of_focus_d(age_years: float) -> float:
    """Difference of the nearest and the farthest focus; bounds: least and greatest at that age."""
    lenses = Lenses(LensesConfig(age_years=age_years))
    focus_d = []
    for activation in (0.0, 1.0):
        lenses.settle(np.full(len(INTRAOCULAR_NAMES), activation))
        focus_d.append(float(lenses.state().focus_d[0]))
    return focus_d[1] - focus_d[0]


@_check("lens: time for 90 % of a step of 2 D", "Campbell & Westheimer 1960", "s", (0.5, 0.75))
def _time_of_a_step_s() -> float:
    """Time from the first movement on; they saw 0.64 s from far to near, with a delay before."""
    lenses, step_s = Lenses(LensesConfig()), 1e-3
    lenses.settle(np.zeros(len(INTRAOCULAR_NAMES)))
    near = np.full(len(INTRAOCULAR_NAMES), ciliary_activation(2.0, LensesConfig().age_years))
    for i in range(1, 2000):
        lenses.advance(near, step_s)
        if lenses.state().accommodation_d[0] >= 0.9 * 2.0:
            return i * step_s
    return math.inf


@_check("blur of 1 D with a pupil of 4 mm", "Smith 1982: 0.229 deg", "deg", (0.22, 0.24))
def _blur_deg() -> float:
    """Diameter of the disc that a foveal pixel becomes, by its second moment, (D / 4)^2."""
    focal_px = 4.0 * CameraConfig().focal_length_px
    kernel = disc_kernel(round(disc_diameter_px(0.004, 1.0, focal_px) / STEP_PX)).astype(float)
    x = np.arange(len(kernel)) - len(kernel) // 2
    variance_px = float((kernel.sum(axis=0) * x**2).sum() / kernel.sum())
    return math.degrees(4.0 * math.sqrt(variance_px) / focal_px)


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(np.square(values))))
