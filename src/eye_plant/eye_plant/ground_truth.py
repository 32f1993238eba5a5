"""What only an experimenter knows: where the eyes look, how far off, and at which cost."""

from dataclasses import dataclass

from eye_plant.gaze_error import GazeError


@dataclass(frozen=True)
class GroundTruth:
    """What only an experimenter knows; learners never see it.

    adduction_deg, elevation_deg, torsion_deg: of the left and the right eye, torsion in Listing's
    coordinates; gaze_error: of the plane at the left fovea; desired_vergence_deg: of the pair that
    of the plane's centre (K17 eq. 6), else that with which the right eye would look where the left
    one does;
    metabolic_rate_w is C, the charged settled rate of both eyes; initial_... is C_0, optimal_... is
    C* (K17 eq. 8), NaN where it is not known: of a gaze target that the muscles do not reach, and
    in training with targets; target_places_deg: where the left and the right eye see the gaze
    target, sideways and up of their lines of sight.
    """

    adduction_deg: tuple[float, float]
    elevation_deg: tuple[float, float]
    torsion_deg: tuple[float, float]
    gaze_error: GazeError
    desired_vergence_deg: float
    metabolic_rate_w: float
    initial_metabolic_rate_w: float
    optimal_metabolic_rate_w: float
    target_places_deg: tuple[float, ...] = (0.0,) * 4

    @property
    def target_deg(self) -> tuple[float, float]:
        """Where the left eye sees the gaze target."""
        sideways_deg, up_deg, *_ = self.target_places_deg
        return sideways_deg, up_deg

    @property
    def vergence_deg(self) -> float:
        """Sum of both eyes' adduction."""
        return sum(self.adduction_deg)

    @property
    def version_deg(self) -> float:
        """Where both eyes look together, half the difference of their adduction; right positive."""
        left_deg, right_deg = self.adduction_deg
        return (left_deg - right_deg) / 2.0

    @property
    def deviations_deg(self) -> tuple[float, float]:
        """How far each eye is turned in beyond half of the desired vergence (K17 eq. 6).

        An eye behind a cover deviates by its phoria; below 0 it is turned out.
        """
        left_deg, right_deg = self.adduction_deg
        half_deg = self.desired_vergence_deg / 2.0
        return left_deg - half_deg, right_deg - half_deg

    @property
    def vergence_error_deg(self) -> float:
        """Positive when the eyes converge too little (K17 eq. 7)."""
        return self.desired_vergence_deg - self.vergence_deg
