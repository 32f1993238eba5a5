"""A robot's head that our own ray caster simulates: quick, and with a known truth."""

import math
from collections.abc import Mapping

import numpy as np

from eye_plant import Head, StimulusSet, desired_vergence_deg
from eye_plant.camera.config import CameraConfig
from eye_plant.stereo_camera import StereoCamera
from tests.eye_plant.rotations import turned_inward

# Another camera than that of the coder: of a focal length of 320 px, and little more than what the
# coder looks at, across and down.
FOCAL_PX, SIZE_PX = 320.0, (176, 160)


class CastHead(Head):
    """Two cameras that jump to their angles, before a plane with pictures."""

    baseline_m = 0.06

    def __init__(self, stimuli: StimulusSet, *, knows: bool = True) -> None:
        """knows: whether it says how far it is off, and places the plane itself."""
        self.limits_rad = {"vergence": (0.0, 0.2)}
        self.focal_length_px = FOCAL_PX
        self.moves: list[Mapping[str, float]] = []
        width_px, height_px = SIZE_PX
        config = CameraConfig(
            focal_length_px=FOCAL_PX,
            width_px=width_px,
            height_px=height_px,
            roi_width_px=width_px,
            roi_height_px=height_px,
        )
        self._camera = StereoCamera(config, stimuli)
        self._n = len(stimuli.training), len(stimuli.test)
        self._knows, self._shown = knows, (0, 1.0)

    def show(self, stimulus: int, distance_m: float) -> bool:
        """Place the plane; numbers from 100 on are those of tests."""
        n_training, n_test = self._n
        of_test = n_training + stimulus % n_test
        self._shown = stimulus % n_training if stimulus < 100 else of_test, distance_m
        return self._knows

    def move(self, angles_rad: Mapping[str, float]) -> None:
        """Be there at once."""
        self.moves.append(angles_rad)

    @property
    def vergence_rad(self) -> float:
        """Where it looks."""
        return self.moves[-1]["vergence"]

    def pictures(self) -> tuple[np.ndarray, np.ndarray]:
        """Cast rays."""
        half_m, half_deg = self.baseline_m / 2.0, math.degrees(self.vergence_rad) / 2.0
        positions_m = np.array([[0.0, half_m, 1.7], [0.0, -half_m, 1.7]])
        rotations = turned_inward(half_deg, half_deg)
        left, right = self._camera.render(positions_m, rotations, *self._shown)
        return left, right

    def truth(self) -> dict[str, float]:
        """Return K17's error, which holds straight ahead."""
        if not self._knows:
            return {}
        desired_deg = desired_vergence_deg(self._shown[1], self.baseline_m)
        return {"vergence_error_deg": desired_deg - math.degrees(self.vergence_rad)}
