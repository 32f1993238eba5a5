"""Measurements of the eyes in motion, of their pictures' disparity, and of the time they take."""

import time
from collections.abc import Iterator

import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.inverse.pair import Inverse
from eye_plant.mechanics.model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.stereo_camera import StereoCamera
from eye_plant.stimuli.stimulus_set import StimulusSet
from eye_plant.validation.passive_energy import passive_energy_j
from eye_plant.validation.row import Row
from eye_plant.validation.saccades import PULSES, Saccade, holding_pair, make_saccade
from eye_plant.validation.static_checks import LIMITS
from eye_plant.vergence import desired_vergence_deg, disparity_px

STEP_BOUND_MS = {"k17": 1.0, "anatomical": 3.0}
DISTANCES_M = (0.5, 1.0, 2.0, 4.0, 6.0)
ERRORS_DEG = (-3.0, -1.0, 0.0, 1.0, 3.0)
# Velocity stops rising once the pulse cannot grow: less than this counts as level.
LEVEL_DEG_S = 2.0

_SPOT_PX = 4.0
_WINDOW_PX = 18
_DARK = 10.0


def energy_row(parameter_set: str) -> Row:
    """How far the energy of a passive, undamped pair of eyes strays over 10 s."""
    energy_j = passive_energy_j(MechanicsConfig(parameter_set=parameter_set), 10.0)
    change = 100.0 * float(np.abs(energy_j / energy_j[0] - 1.0).max())
    return Row(f"{parameter_set}: energy change of a passive eye in 10 s", change, "%", high=1.0)


def step_time_row(parameter_set: str, n_steps: int = 400) -> Row:
    """Median time of one iteration of both eyes, no pictures: step and read out."""
    eyes = Oculomotor(MechanicsConfig(parameter_set=parameter_set))
    generator = np.random.default_rng(0)
    commands = [eyes.activations_from(*generator.uniform(0.0, (0.2, 0.1))) for _ in range(n_steps)]
    times_s = []
    for command in commands:
        start_s = time.perf_counter()
        eyes.step(command)
        eyes.state()
        times_s.append(time.perf_counter() - start_s)
    median_ms = 1e3 * float(np.median(times_s))
    high = STEP_BOUND_MS[parameter_set]
    return Row(f"{parameter_set}: one iteration of both eyes, median", median_ms, "ms", high=high)


def saccades() -> dict[float, Saccade]:
    """The anatomical eyes' saccades by amplitude in deg."""
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical", timestep_s=1e-3))
    return {
        amplitude_deg: make_saccade(eyes, holding_pair(eyes, amplitude_deg), command)
        for amplitude_deg, command in PULSES.items()
    }


def saccade_rows(made: dict[float, Saccade]) -> Iterator[Row]:
    """Duration and peak velocity against the main sequence of 5 to 30 deg."""
    for amplitude_deg, saccade in made.items():
        name = f"anatomical: saccade of {amplitude_deg:g} deg"
        usual_ms = 2.2 * amplitude_deg + 21.0
        yield Row(f"{name}, duration", saccade.duration_ms, "ms", 0.75 * usual_ms, 1.25 * usual_ms)
        low, high = 0.95 * amplitude_deg, 1.05 * amplitude_deg
        yield Row(f"{name}, amplitude", saccade.amplitude_deg, "deg", low, high)
    peaks = np.array([saccade.peak_velocity_deg_s for saccade in made.values()])
    slopes = np.diff(peaks)
    yield Row("anatomical: peak velocity at 10 deg", float(peaks[1]), "deg/s", 300.0, 450.0)
    yield Row("anatomical: greatest peak velocity", float(peaks.max()), "deg/s", high=900.0)
    falls = float(np.count_nonzero(slopes < -LEVEL_DEG_S))
    yield Row("anatomical: falls of peak velocity with amplitude", falls, "", high=0.0)
    share = float(slopes[-1] / slopes[0])
    yield Row("anatomical: last rise of peak velocity over the first", share, "", high=0.5)


def disparity_row(parameter_set: str) -> Row:
    """Worst disparity of the plane's centre point against 2 F tan(e / 2), through the renderer."""
    name = f"{parameter_set}: disparity of the centre point, 0.5 to 6 m, -3 to 3 deg, worst"
    config, mechanics = CameraConfig(), MechanicsConfig(parameter_set=parameter_set)
    spots = tuple(spot(config, distance_m) for distance_m in DISTANCES_M)
    camera = StereoCamera(config, StimulusSet(spots, ()), mechanics.eye_height_m)
    worst_px = max(
        _disparity_error_px(config, mechanics, camera, i, error_deg)
        for i in range(len(DISTANCES_M))
        for error_deg in ERRORS_DEG
    )
    return Row(name, worst_px, "px", high=0.05)


def _disparity_error_px(
    config: CameraConfig,
    mechanics: MechanicsConfig,
    camera: StereoCamera,
    i_distance: int,
    error_deg: float,
) -> float:
    distance_m = DISTANCES_M[i_distance]
    vergence_deg = desired_vergence_deg(distance_m, mechanics.baseline_m) - error_deg
    pair = Inverse(mechanics).activation_pair(vergence_deg, 0.5, LIMITS)
    eyes = Oculomotor(mechanics)
    eyes.settle(eyes.activations_from(*pair))
    pictures = camera.render(eyes.eye_positions_m(), eyes.eye_rotations(), i_distance, distance_m)
    left_px, right_px = (_spot_column_px(picture) for picture in pictures)
    return abs(left_px - right_px - disparity_px(error_deg, config.focal_length_px))


def spot(config: CameraConfig, distance_m: float, size_px: int = 1920) -> np.ndarray:
    """A bright Gaussian spot on black, four camera pixels wide when seen from distance_m."""
    per_camera_px = distance_m / config.focal_length_px / config.plane_size_m * size_px
    offset = (np.arange(size_px) - 0.5 * (size_px - 1)) / (_SPOT_PX * per_camera_px)
    profile = np.exp(-0.5 * offset**2)
    return np.rint(255.0 * np.outer(profile, profile)).astype(np.uint8)


def _spot_column_px(picture: np.ndarray) -> float:
    """Centre of mass of the spot, in columns; its rim is mostly rounding and is left out."""
    middle = picture.shape[0] // 2
    band = picture[middle - 60 : middle + 60].astype(np.float64)
    brightest = int(band.max(axis=0)[60:-60].argmax()) + 60
    columns = np.arange(brightest - _WINDOW_PX, brightest + _WINDOW_PX + 1)
    light = np.maximum(band[:, columns] - _DARK, 0.0).sum(axis=0)
    return float((light * columns).sum() / light.sum())
