import dataclasses
import math
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from eye_plant import Episode, EyePlant, EyePlantConfig, Head
from eye_plant.head.messages import camera_info
from eye_plant.head.plant import HeadPlant
from lockstep import COMMAND_SPACES, InputError
from lockstep.optics import Pinhole
from lockstep.wire.topics import GROUND_TRUTH_NAMES

EPISODE = Episode(
    phase=0,
    test=-1,
    trial=-1,
    episode=4,
    training_iteration=40,
    stimulus=7,
    object_distance_m=1.5,
    joints_rad=(0.1,),
    n_iterations=2,
    first_observation=44,
)


class StillHead(Head):
    """Grey pictures, or others; it gets no further than 0.15 rad."""

    def __init__(self) -> None:
        self.limits_rad: Mapping[str, tuple[float, float]] = {"vergence": (0.0, 0.2)}
        self.shown: Any = (np.full((4, 6), 9, np.uint8),) * 2
        self.known: dict[str, float] = {}
        self.n_taken = 0

    def move(self, angles_rad: Mapping[str, float]) -> Mapping[str, float]:
        return {name: min(angle, 0.15) for name, angle in angles_rad.items()}

    def pictures(self) -> tuple[np.ndarray, np.ndarray]:
        self.n_taken += 1
        pictures: tuple[np.ndarray, np.ndarray] = self.shown
        return pictures

    def truth(self) -> Mapping[str, float]:
        return self.known


def _truth(head: Head) -> dict[str, float]:
    values = HeadPlant(head).begin(EPISODE).ground_truth_values()
    return dict(zip(GROUND_TRUTH_NAMES, values, strict=True))


def test_an_episode_from_its_start_to_its_last_observation() -> None:
    head, space = StillHead(), COMMAND_SPACES["vergence"]
    plant = HeadPlant(head)
    seen = plant.begin(EPISODE)
    assert seen.commanded(space).tolist() == [0.1]
    assert seen.rates_w(space).shape == (0,)
    assert seen.pictures is not None
    assert seen.pictures.shape == (2, 4, 6)
    asked = plant.targets(["vergence"], np.array([0.7]))
    assert asked.tolist() == [0.2], "the limit of the head"
    assert plant.execute(asked).angles_rad.tolist() == [0.15], "where it says that it is"
    last = plant.execute(plant.targets(["vergence"], np.array([-1.0])))
    assert (last.number, last.training_iteration, last.angles_rad.tolist()) == (46, 42, [0.0])
    assert last.pictures is last.cameras is None
    assert head.n_taken == 2, "nobody looks at the last observation"
    with pytest.raises(InputError, match="expected a command during an episode only"):
        plant.execute(asked)


def test_what_nobody_knows_is_nan_and_what_follows_is_told() -> None:
    head = StillHead()
    truth = _truth(head)
    known = {name for name, value in truth.items() if not math.isnan(value)}
    unknown = set(GROUND_TRUTH_NAMES[8:]) - {"vergence_deg"}
    assert known == set(GROUND_TRUTH_NAMES) - unknown
    assert truth["vergence_deg"] == pytest.approx(math.degrees(0.1))
    head.known = {"vergence_error_deg": -2.0}
    assert _truth(head)["desired_vergence_deg"] == pytest.approx(math.degrees(0.1) - 2.0)
    head.known = {"weather": 1.0}
    with pytest.raises(InputError, match=r"truth: expected some of .*, got weather"):
        _truth(head)


def test_colours_become_grey() -> None:
    head = StillHead()
    head.shown = (np.full((4, 6, 3), (255, 0, 0), np.uint8),) * 2  # blue
    seen = HeadPlant(head).begin(EPISODE)
    assert seen.pictures is not None
    assert np.unique(seen.pictures).tolist() == [29]  # 0.114 of it (ITU-R BT.601)


@pytest.mark.parametrize(
    ("shapes", "message"),
    [
        (((4, 6), (4, 8)), r"two images of one size, left and right, got \[\(4, 6\), \(4, 8\)\]"),
        (((4, 6, 4), (4, 6, 4)), r"expected uint8 of shape .* got uint8 of shape \(4, 6, 4\)"),
        (((4, 6),), "two images of one size"),
    ],
)
def test_pictures_that_nobody_can_use_are_refused(shapes, message: str) -> None:
    head = StillHead()
    head.shown = tuple(np.zeros(shape, np.uint8) for shape in shapes)
    with pytest.raises(InputError, match=message):
        HeadPlant(head).begin(EPISODE)


@pytest.mark.parametrize(
    ("joints_rad", "message"),
    [
        ((0.3,), r"expected vergence from 0 to 0.2 rad, the limits of the head, got 0.3000"),
        ((0.1, 0.1), r"joints_rad: expected vergence, got \[0.1, 0.1\]"),
    ],
)
def test_an_episode_beyond_the_limits_is_refused(joints_rad, message: str) -> None:
    with pytest.raises(InputError, match=message):
        HeadPlant(StillHead()).begin(dataclasses.replace(EPISODE, joints_rad=joints_rad))


@pytest.mark.parametrize(
    ("names", "values"),
    [(["pan"], [0.0]), (["vergence", "vergence"], [0.0, 0.0]), (["vergence"], [math.nan])],
)
def test_other_commands_are_refused(names: list[str], values: list[float]) -> None:
    plant = HeadPlant(StillHead())
    plant.begin(EPISODE)
    with pytest.raises(InputError, match="joint_command: expected"):
        plant.targets(names, np.array(values))


@pytest.mark.parametrize("reached", [{}, {"vergence": math.nan}])
def test_a_head_that_does_not_know_where_it_is_is_refused(
    reached: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    head = StillHead()
    monkeypatch.setattr(head, "move", lambda _: reached)
    with pytest.raises(InputError, match="move: expected finite angles of vergence, got"):
        HeadPlant(head).begin(EPISODE)


def test_the_joints_choose_the_command_space() -> None:
    head = StillHead()
    head.limits_rad = dict.fromkeys(("vergence", "tilt", "pan"), (-1.0, 1.0))
    assert HeadPlant(head).command_space == "pan_tilt_vergence"
    with pytest.raises(InputError, match="expected pan_tilt_vergence, whose joints the head has"):
        HeadPlant(head, EyePlantConfig(command_space="vergence"))
    head.limits_rad = {"elbow": (0.0, 1.0)}
    with pytest.raises(InputError, match="expected vergence; or pan, tilt, vergence, got elbow"):
        HeadPlant(head)


def test_a_head_and_a_run_with_another_baseline_are_refused() -> None:
    head = StillHead()
    head.baseline_m = 0.07
    config = EyePlantConfig(command_space="vergence")
    with pytest.raises(InputError, match=r"baseline_m: expected 0.07, as the head has it"):
        HeadPlant(head, config)


def test_eyes_have_no_joints() -> None:
    with pytest.raises(InputError, match="expected one of muscles, got vergence"):
        EyePlant(EyePlantConfig(command_space="vergence"))


def test_the_calibration_that_is_published() -> None:
    info = camera_info(Pinhole((300.0, 310.0), (160.0, 119.0), (0.1, 0.2)), (240, 320), 0.06)
    assert (info.height, info.width, info.distortion_model) == (240, 320, "plumb_bob")
    assert list(info.d) == [0.1, 0.2, 0.0, 0.0, 0.0]
    assert list(info.k) == [300.0, 0.0, 160.0, 0.0, 310.0, 119.0, 0.0, 0.0, 1.0]
    assert info.p[3] == -300.0 * 0.06


def test_the_page_names_all_that_a_head_provides() -> None:
    page = (Path(__file__).parents[3] / "docs" / "how_to" / "own_head.md").read_text()
    table = page.split("\n## What a head provides\n")[1].split("\n- **")[0]
    named = {re.sub(r"\(.*", "", name) for name in re.findall(r"^\| `([^`]+)`", table, re.M)}
    assert named == {name for name in vars(Head) if not name.startswith("_")}
