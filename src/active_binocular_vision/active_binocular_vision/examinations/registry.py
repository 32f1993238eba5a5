"""All examinations by their names."""

from active_binocular_vision.examinations.acuity import ACUITY
from active_binocular_vision.examinations.cover import COVER
from active_binocular_vision.examinations.landscape import LANDSCAPE
from active_binocular_vision.examinations.main_sequence import MAIN_SEQUENCE
from active_binocular_vision.examinations.nine_positions import NINE_POSITIONS
from active_binocular_vision.examinations.prisms import PRISMS
from active_binocular_vision.examinations.stereo import STEREO
from active_binocular_vision.examinations.tuning import TUNING

EXAMINATIONS = {
    examination.name: examination
    for examination in (
        COVER,
        PRISMS,
        ACUITY,
        STEREO,
        NINE_POSITIONS,
        MAIN_SEQUENCE,
        LANDSCAPE,
        TUNING,
    )
}
