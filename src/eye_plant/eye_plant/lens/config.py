"""Settings of lenses and pupils: age, refraction, glasses, drugs."""

from dataclasses import dataclass

from lockstep import check_settings, setting

# From a spectacle lens to the cornea (usual in prescriptions, Bennett & Rabbetts 1998).
VERTEX_M = 0.012


@dataclass(frozen=True)
class LensesConfig:
    """Lenses and pupils, of the left and the right eye; raises InputError for values out of range.

    They count for eyes whose command space has lenses; all others see every distance in focus.
    """

    age_years: float = setting(
        20.0, "age, with which the range of accommodation falls", "years", least=0, most=100
    )
    resting_accommodation_d: float = setting(
        1.5,
        "accommodation of a ciliary muscle that nobody commands",
        "D",
        least=0,
        most=10,
    )
    resting_pupil_mm: float = setting(
        4.0, "diameter of a pupil that nobody commands", "mm", least=2, most=8
    )
    refraction_d: tuple[float, ...] = setting(
        (0.0, 0.0),
        "refraction of each eye: the lens with which it sees far distances without accommodation;"
        " positive: hyperopia, negative: myopia",
        "D",
        least=-20,
        most=20,
        n_entries=2,
    )
    spectacles_d: tuple[float, ...] = setting(
        (0.0, 0.0),
        "power of the spectacle lens before each eye, 12 mm from it; it also magnifies",
        "D",
        least=-20,
        most=20,
        n_entries=2,
    )
    contact_lenses_d: tuple[float, ...] = setting(
        (0.0, 0.0), "power of the contact lens on each eye", "D", least=-20, most=20, n_entries=2
    )
    pinhole_mm: tuple[float, ...] = setting(
        (8.0, 8.0),
        "diameter of an aperture before each eye, which a wider pupil does not exceed",
        "mm",
        above=0,
        most=8,
        n_entries=2,
    )
    cycloplegia: tuple[float, ...] = setting(
        (0.0, 0.0),
        "share of the activation that drops take from the ciliary muscle and the sphincter of the"
        " pupil of each eye; 1: both are paralysed",
        least=0,
        most=1,
        n_entries=2,
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)

    @property
    def magnifications(self) -> tuple[float, float]:
        """How much the spectacle lenses magnify: 1 / (1 - v S), v the distance, S the power.

        The power factor of spectacle magnification (Bennett & Rabbetts 1998); of thin lenses it is
        all of it, and of contact lenses it is 1.
        """
        left_d, right_d = self.spectacles_d
        return 1.0 / (1.0 - VERTEX_M * left_d), 1.0 / (1.0 - VERTEX_M * right_d)
