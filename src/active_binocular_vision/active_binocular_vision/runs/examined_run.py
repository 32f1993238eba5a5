"""A run whose learners were examined at birth, before its first change and at the end: clinic.json.

The file lies in the run's directory, so that a page can be drawn again without checkpoints.
"""

import dataclasses
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

from lockstep import InputError
from lockstep.durable_files import replace_file

EXAMINED_FILE = "clinic.json"
BIRTH, BEFORE, END = "birth", "before", "end"
AGES = (BIRTH, BEFORE, END)


@dataclass(frozen=True, kw_only=True)
class ExaminedAge:
    """Measures of the learners of one age, as in docs/clinic.md; None where there is none.

    when: one of AGES; iteration: of training. Deviations are those of the covered right eye, in
    prism dioptres, above 0 where it is turned in, or higher. Binocular shares are those of the
    Gabor functions. The last two are of the run's own test at that age.
    """

    when: str
    iteration: int
    horizontal_deviation_pd: float | None
    vertical_deviation_pd: float | None
    share_fused: float
    left_acuity_cycles_per_deg: float | None
    right_acuity_cycles_per_deg: float | None
    stereo_threshold_arcsec: float | None
    left_share_in_code: float | None
    binocular_share_coarse: float | None
    binocular_share_fine: float | None
    metabolic_rate_w: float | None
    share_within_1_px: float | None


@dataclass(frozen=True, kw_only=True)
class ExaminedRun:
    """One run of a condition.

    condition: its profile without the folder; iterations: of training; changed_at: training
    iterations before the schedule's first change, None without one; final_learning_rate: of the
    dictionaries, 0 where they come to rest; ages: in the order of AGES, those that were tested.
    """

    condition: str
    model: str
    seed: int
    iterations: int
    changed_at: int | None
    final_learning_rate: float
    ages: tuple[ExaminedAge, ...]

    def at(self, when: str) -> ExaminedAge | None:
        """Return the measures of an age, None where there was no test."""
        return next((age for age in self.ages if age.when == when), None)

    def write(self, directory: Path) -> None:
        """Write the file into a run's directory; raises OSError when the disk refuses."""
        text = json.dumps(dataclasses.asdict(self), indent=1, allow_nan=False)
        replace_file(directory / EXAMINED_FILE, f"{text}\n".encode())

    @classmethod
    def read(cls, directory: Path) -> Self | None:
        """Return what `write` wrote, None without the file; InputError for another content."""
        path = directory / EXAMINED_FILE
        if not path.is_file():
            return None
        try:
            document: dict[str, Any] = json.loads(path.read_bytes())
            ages = tuple(ExaminedAge(**age) for age in document.pop("ages"))
            return cls(**document, ages=ages)
        except (ValueError, KeyError, TypeError, AttributeError) as error:
            raise InputError(f"{path}: expected the examinations of a run: {error!r}") from error


def ages_of(tested: Sequence[int], changed_at: int | None) -> Mapping[str, int]:
    """Return the training iterations of each of AGES that a run has been tested at.

    tested: training iterations before each test, rising, the last one at the end; changed_at: those
    before the first change. A test at that very iteration still comes before it.
    """
    before = [n for n in tested[:-1] if changed_at is not None and 0 < n <= changed_at]
    ages = {BIRTH: 0} if tested[0] == 0 else {}
    return ages | ({BEFORE: before[-1]} if before else {}) | {END: tested[-1]}
