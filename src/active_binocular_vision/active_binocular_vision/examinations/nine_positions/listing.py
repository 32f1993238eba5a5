"""Listing's law: in which plane an eye's rotation vectors lie, and how vergence turns it.

A rotation by theta about the unit vector n is r = tan(theta / 2) n (Haustein 1989). Those of an eye
that obeys Listing's law lie in a plane, whatever gaze they are measured from: the displacement
plane. It is turned half as far from the frontal plane as the primary position is from straight
ahead (Tweed & Vilis 1990).
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Offset and two slopes.
_N_FITTED = 3


@dataclass(frozen=True)
class DisplacementPlane:
    """The plane r_x = a + b r_y + c r_z of one eye's rotation vectors.

    offset_deg: 2 atan(a), torsion straight ahead, the upper pole toward the nose above 0;
    temporal_tilt_deg, upward_tilt_deg: of the plane's normal from straight ahead; thickness_deg: SD
    of the torsion 2 r_x about the plane.
    """

    offset_deg: float
    temporal_tilt_deg: float
    upward_tilt_deg: float
    thickness_deg: float

    def torsion_deg(self, up_deg: Array, temple_deg: float) -> Array:
        """Return the torsion of eyes in the plane, 2 atan(r_x), at gazes in Listing's coordinates.

        up_deg (...), temple_deg: angles 2 atan of the rotation vector's components up and to the
        temple.
        """
        of_down, of_temple = -np.tan(np.radians([self.temporal_tilt_deg, self.upward_tilt_deg]))
        down, temple = -np.tan(np.radians(up_deg) / 2.0), np.tan(np.radians(temple_deg) / 2.0)
        offset = np.tan(np.radians(self.offset_deg) / 2.0)
        torsion: Array = offset + of_down * down + of_temple * temple
        return 2.0 * np.degrees(np.arctan(torsion))


def rotation_vectors(rotations: Array) -> Array:
    """Return rotation vectors (..., 2, 3) of left and right eyes from straight ahead.

    rotations: (..., 2, 3, 3), columns forward, left and up. Components: about the line straight
    ahead, upper pole toward the nose above 0; down; toward the temple. The right eye's are those of
    its mirror image.
    """
    r = np.moveaxis(rotations, (-2, -1), (0, 1))
    vectors = np.stack([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]], axis=-1)
    vectors /= (1.0 + np.trace(r))[..., None]
    mirrored: Array = vectors * np.array([[1.0, 1.0, 1.0], [-1.0, 1.0, -1.0]])
    return mirrored


def displacement_plane(vectors: Array) -> DisplacementPlane:
    """Fit the plane of one eye's rotation vectors (n, 3) by least squares of torsion.

    n is more than 3, not all in one line.
    """
    torsion, others = vectors[:, 0], vectors[:, 1:]
    columns = np.column_stack([np.ones(len(vectors)), others])
    fitted = np.linalg.lstsq(columns, torsion)[0]
    residual = torsion - columns @ fitted
    variance = (residual**2).sum() / (len(vectors) - _N_FITTED)
    offset, of_down, of_temporal = fitted.tolist()
    # The normal is (1, -b, -c); what turns the eye down lies along the axis to the temple, what
    # turns it to the temple along the axis up.
    return DisplacementPlane(
        offset_deg=float(2.0 * np.degrees(np.arctan(offset))),
        temporal_tilt_deg=float(np.degrees(np.arctan(-of_down))),
        upward_tilt_deg=float(np.degrees(np.arctan(-of_temporal))),
        thickness_deg=float(np.degrees(2.0 * np.sqrt(variance))),
    )


def tilt_per_vergence(temporal_tilts_deg: Array, vergences_deg: Array) -> float:
    """Return by how much a plane turns to the temple per deg of vergence, both (n,).

    The least-squares slope. Human planes turn that way as the eyes converge (Mok, Ro, Cadera,
    Crawford & Vilis 1992).
    """
    slope, _ = np.polyfit(vergences_deg, temporal_tilts_deg, 1)
    return float(slope)
