"""All examinations by their names."""

from active_binocular_vision.examinations.clinic.acuity import ACUITY
from active_binocular_vision.examinations.clinic.cover import COVER
from active_binocular_vision.examinations.clinic.prisms import PRISMS
from active_binocular_vision.examinations.clinic.stereo import STEREO
from active_binocular_vision.examinations.code.landscape import LANDSCAPE
from active_binocular_vision.examinations.code.tuning import TUNING
from active_binocular_vision.examinations.lenses.accommodation import ACCOMMODATION
from active_binocular_vision.examinations.lenses.near_point import NEAR_POINT
from active_binocular_vision.examinations.lenses.retinoscopy import RETINOSCOPY
from active_binocular_vision.examinations.nine_positions.examination import NINE_POSITIONS
from active_binocular_vision.examinations.saccades.main_sequence import MAIN_SEQUENCE

EXAMINATIONS = {
    examination.name: examination
    for examination in (
        COVER,
        PRISMS,
        ACUITY,
        STEREO,
        ACCOMMODATION,
        RETINOSCOPY,
        NEAR_POINT,
        NINE_POSITIONS,
        MAIN_SEQUENCE,
        LANDSCAPE,
        TUNING,
    )
}
