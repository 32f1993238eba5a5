"""What a robot's head must do to take the place of the eyes: move, take pictures, say who it is."""

from abc import ABC, abstractmethod
from collections.abc import Mapping

import numpy as np

from lockstep.optics import Pinhole

Angles = Mapping[str, float]


class Head(ABC):
    """Two cameras that turn toward each other, perhaps on a neck: subclass it, and `run_head` it.

    `move` and `pictures` must be there; docs/how_to/own_head.md says more.

    Attributes:
        limits_rad: least and largest angle of each joint, by name: of `vergence`, or of `pan`,
            `tilt` and `vergence`. These names are the command space. Commands are clipped to the
            limits; an episode that would begin beyond them is refused.
        baseline_m: distance of both cameras' centres.
        focal_length_px: of both cameras, in their pixels; unless `camera` says more.
        frame_ids: of the left and the right picture.

    Example:
        >>> import numpy as np
        >>> from eye_plant import Head
        >>> class MyHead(Head):
        ...     limits_rad = {"vergence": (0.0, 0.3)}
        ...     focal_length_px = 300.0
        ...     def move(self, angles_rad):
        ...         self.vergence_rad = angles_rad["vergence"]
        ...     def pictures(self):
        ...         return np.zeros((480, 640), np.uint8), np.zeros((480, 640), np.uint8)
        >>> MyHead().camera(0, 480, 640).centre_px
        (319.5, 239.5)
    """

    limits_rad: Mapping[str, tuple[float, float]] = {"vergence": (0.0, 0.2)}
    baseline_m: float = 0.056
    focal_length_px: float = 257.34
    frame_ids: tuple[str, str] = ("left_camera_optical_frame", "right_camera_optical_frame")

    @abstractmethod
    def move(self, angles_rad: Angles) -> Angles | None:
        """Turn to these angles, by joint, and return when the head is there.

        Vergence is the sum of both cameras' turns toward each other, pan is positive to the right,
        tilt up. Return the angles that were reached where they may differ, else None.
        """

    @abstractmethod
    def pictures(self) -> tuple[np.ndarray, np.ndarray]:
        """Return what the left and the right camera see now.

        (height, width) uint8, or (height, width, 3) with BGR as OpenCV has it; one size for both.
        """

    def camera(self, i_eye: int, height_px: int, width_px: int) -> Pinhole:
        """Return the calibration of the left (0) or right (1) camera, for pictures of that size."""
        return Pinhole.ideal(self.focal_length_px, height_px, width_px)

    def show(self, stimulus: int, distance_m: float) -> bool:
        """Place a new object before the head; return whether that was done.

        Called before each episode, with the number of a picture (those of tests differ from those
        of training) and a distance. A head that looks at the world as it is leaves this out.
        """
        return False

    def truth(self) -> Mapping[str, float]:
        """Return what is known of the true errors, by name of ground truth; nothing by default.

        `vergence_error_deg` (desired minus actual vergence) is what tests report. No learner gets
        it. Left out, or NaN, where nobody knows.
        """
        return {}

    def close(self) -> None:  # noqa: B027 (there may be nothing to release)
        """Release cameras and motors; called at the end."""
