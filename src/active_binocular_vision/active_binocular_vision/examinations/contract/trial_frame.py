"""A trial frame: lenses, prisms and pinholes that an examiner holds before the eyes."""

import math
from dataclasses import replace
from typing import Any

from active_binocular_vision.examinations.contract.declared import TrialFrame
from active_binocular_vision.learners.learners import FrozenLearners
from active_binocular_vision.learners.session import check_has_lenses
from eye_plant.config import EyesConfig
from lockstep import SIDES

_NOTHING = TrialFrame()


def behind(learners: FrozenLearners, frame: TrialFrame, option: str) -> FrozenLearners:
    """Return learners whose eyes look through a frame.

    Raises InputError, which names the option, for lenses and pinholes before eyes without lenses.
    """
    prisms_alone = replace(_NOTHING, prisms_pd=frame.prisms_pd)
    if all(getattr(frame, name) == value for name, value in vars(prisms_alone).items()):
        frame = prisms_alone
    else:
        check_has_lenses(learners, f"{option}: lenses_d, pinholes_mm")
    return replace(learners, settings={**learners.settings, **held(learners.plant, frame)})


def held(eyes: EyesConfig, frame: TrialFrame) -> dict[str, Any]:
    """Return the settings of eyes that look through a frame, those that it changes.

    A lens changes the focus as a contact lens of its power does, and does not magnify. A prism with
    the base out turns the picture as a camera that is turned toward the temple.
    """
    own = eyes.lenses
    turns_deg = [math.degrees(math.atan(pd / 100.0)) for pd in frame.prisms_pd]
    settings: dict[str, Any] = {
        f"camera.{side}_rotation_deg": getattr(eyes.camera, f"{side}_rotation_deg") - turn_deg
        for side, turn_deg in zip(SIDES, turns_deg, strict=True)
        if turn_deg
    }
    if frame.lenses_d != _NOTHING.lenses_d:
        pairs = zip(own.contact_lenses_d, frame.lenses_d, strict=True)
        settings["lenses.contact_lenses_d"] = tuple(worn + lens for worn, lens in pairs)
    if frame.pinholes_mm != _NOTHING.pinholes_mm:
        pairs = zip(own.pinhole_mm, frame.pinholes_mm, strict=True)
        settings["lenses.pinhole_mm"] = tuple(min(pair) for pair in pairs)
    return settings
