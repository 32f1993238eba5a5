"""What two eyes do at rest: how they are turned, and what their muscles do and cost."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.nine_positions.listing import rotation_vectors
from eye_plant.gaze_error import direction_deg, gaze_error, target_places_deg
from eye_plant.mechanics.oculomotor import Oculomotor
from eye_plant.turns import TurnsDeg, turned

Array = NDArray[np.float64]

ERROR_AXES = ("horizontal", "vertical", "cyclovergence")


@dataclass(frozen=True)
class Posture:
    """Eyes at one gaze or, with further dimensions in front, at many.

    rotations: (..., 2, 3, 3) of left and right eye, columns forward, left and up; sights: (..., 2,
    3) where their cameras look, which may be turned in the eyes; activations: (..., 12);
    metabolic_rate_w: (...), C of the commanded muscles; errors_deg: (..., 3) as GazeError has them,
    of what the cameras see; missed_deg: (...) angle between the line of sight of the camera that
    leads and the target. All NaN for a gaze that the eyes do not reach.
    """

    rotations: Array
    sights: Array
    activations: Array
    metabolic_rate_w: Array
    errors_deg: Array
    missed_deg: Array

    @classmethod
    def of(
        cls,
        eyes: Oculomotor,
        turns_deg: TurnsDeg,
        commanded: NDArray[np.intp],
        target_deg: Sequence[float],
        distance_m: float,
        *,
        leads: int,
    ) -> Self:
        """Read out eyes.

        turns_deg: of their cameras; commanded: positions of the muscles whose rate counts; leads: 0
        the left eye, 1 the right one.
        """
        state, rotations, positions_m = eyes.state(), eyes.eye_rotations(), eyes.eye_positions_m()
        cameras = turned(rotations, turns_deg)
        error = gaze_error(positions_m, cameras, distance_m)
        places_deg = target_places_deg(positions_m, cameras, target_deg, distance_m)
        return cls(
            rotations,
            cameras[..., 0],
            state.activations,
            state.metabolic_rate_w[commanded].sum(),
            np.array([error.horizontal_deg, error.vertical_deg, error.torsional_deg]),
            np.hypot(*np.reshape(places_deg, (2, 2))[leads]),
        )

    @classmethod
    def unreached(cls) -> Self:
        """Return what stands for a gaze that the eyes do not reach."""
        shapes = (2, 3, 3), (2, 3), (12,), (), (3,), ()
        return cls(*(np.full(shape, np.nan) for shape in shapes))

    @classmethod
    def stacked(cls, postures: Sequence[Self], shape: tuple[int, ...]) -> Self:
        """Return single postures in the order of an array of that shape."""
        columns = {f.name: np.stack([getattr(p, f.name) for p in postures]) for f in fields(cls)}
        return cls(**{name: c.reshape(*shape, *c.shape[1:]) for name, c in columns.items()})

    @cached_property
    def gaze_deg(self) -> Array:
        """Azimuth (right) and elevation (..., 2, 2) of each camera's line of sight."""
        return direction_deg(self.sights)

    @cached_property
    def vergence_deg(self) -> Array:
        """Difference (...) of both eyes' azimuths, above 0 where they converge."""
        left_deg, right_deg = np.moveaxis(direction_deg(self.rotations[..., 0])[..., 0], -1, 0)
        return np.asarray(left_deg - right_deg)

    @cached_property
    def rotation_vectors(self) -> Array:
        """Rotation vectors (..., 2, 3) of the eyes from straight ahead; see `rotation_vectors`."""
        return rotation_vectors(self.rotations)

    @cached_property
    def torsion_deg(self) -> Array:
        """Each eye's torsion in Listing's coordinates (..., 2), as listing_torsion_deg has it."""
        return 2.0 * np.degrees(np.arctan(self.rotation_vectors[..., 0]))
