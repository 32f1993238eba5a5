"""What two eyes do at rest: how they are turned, and what their muscles do and cost."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from active_binocular_vision.examinations.positions.listing import rotation_vectors
from active_binocular_vision.examinations.positions.targets import direction_deg
from eye_plant.gaze_error import gaze_error, target_place_deg
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import MUSCLE_NAMES, SIDES

Array = NDArray[np.float64]

ERROR_AXES = ("horizontal", "vertical", "cyclovergence")


@dataclass(frozen=True)
class Posture:
    """Eyes at one gaze or, with further dimensions in front, at many.

    rotations: (..., 2, 3, 3) of left and right eye, columns forward, left and up; activations:
    (..., 12); metabolic_rate_w: (...), C of the commanded muscles; errors_deg: (..., 3) as
    GazeError has them; missed_deg: (...) angle between the left line of sight and the target. All
    NaN for a gaze that the eyes do not reach.
    """

    rotations: Array
    activations: Array
    metabolic_rate_w: Array
    errors_deg: Array
    missed_deg: Array

    @classmethod
    def of(
        cls,
        eyes: Oculomotor,
        commanded: NDArray[np.intp],
        target_deg: Sequence[float] | Array,
        distance_m: float,
    ) -> Self:
        """Read out eyes; commanded: positions of the muscles whose rate counts."""
        state, rotations = eyes.state(), eyes.eye_rotations()
        error = gaze_error(eyes.eye_positions_m(), rotations, distance_m)
        azimuth_deg, elevation_deg = target_deg
        place_deg = target_place_deg(rotations[0], azimuth_deg, elevation_deg)
        return cls(
            rotations,
            state.activations,
            state.metabolic_rate_w[commanded].sum(),
            np.array([error.horizontal_deg, error.vertical_deg, error.torsional_deg]),
            np.hypot(*place_deg),
        )

    @classmethod
    def unreached(cls) -> Self:
        """Return what stands for a gaze that the eyes do not reach."""
        shapes = (2, 3, 3), (12,), (), (3,), ()
        return cls(*(np.full(shape, np.nan) for shape in shapes))

    @classmethod
    def stacked(cls, postures: Sequence[Self], shape: tuple[int, ...]) -> Self:
        """Return single postures in the order of an array of that shape."""
        columns = {f.name: np.stack([getattr(p, f.name) for p in postures]) for f in fields(cls)}
        return cls(**{name: c.reshape(*shape, *c.shape[1:]) for name, c in columns.items()})

    @cached_property
    def gaze_deg(self) -> Array:
        """Azimuth (right) and elevation (..., 2, 2) of each line of sight."""
        return direction_deg(self.rotations[..., 0])

    @cached_property
    def vergence_deg(self) -> Array:
        """Difference (...) of both eyes' azimuths, above 0 where they converge."""
        left_deg, right_deg = np.moveaxis(self.gaze_deg[..., 0], -1, 0)
        return np.asarray(left_deg - right_deg)

    @cached_property
    def rotation_vectors(self) -> Array:
        """Rotation vectors (..., 2, 3) from straight ahead; see `rotation_vectors`."""
        return rotation_vectors(self.rotations)

    @cached_property
    def torsion_deg(self) -> Array:
        """Each eye's torsion in Listing's coordinates (..., 2), as listing_torsion_deg has it."""
        return 2.0 * np.degrees(np.arctan(self.rotation_vectors[..., 0]))

    def readings(self) -> dict[str, Array]:
        """Return what a document has of each posture, (...) by name."""
        values = {
            f"{side}_{angle}_deg": self.gaze_deg[..., i_side, i_angle]
            for i_side, side in enumerate(SIDES)
            for i_angle, angle in enumerate(("azimuth", "elevation"))
        }
        values |= {f"{side}_torsion_deg": self.torsion_deg[..., i] for i, side in enumerate(SIDES)}
        values |= {
            f"{axis}_error_deg": self.errors_deg[..., i] for i, axis in enumerate(ERROR_AXES)
        }
        values |= {"missed_deg": self.missed_deg, "metabolic_rate_w": self.metabolic_rate_w}
        return values | {name: self.activations[..., i] for i, name in enumerate(MUSCLE_NAMES)}
