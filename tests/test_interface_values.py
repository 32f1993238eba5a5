"""docs/reference/topics.md against what is sent: fields, units, ranges, periods."""

from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from sensor_msgs.msg import JointState

from experiment_manager import make_loop
from experiment_manager.sections import config_of
from experiment_manager.step_messages import StepMessages
from eye_plant import Episode, EyePlantConfig
from eye_plant.camera.config import CameraConfig
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from eye_plant.mechanics.oculomotor import Oculomotor
from lockstep import MUSCLE_NAMES
from lockstep.wire.topics import TEST, TRAINING
from lockstep.wire.vectors import read_vector
from tests.interfaces_page import PAGE, VECTORS, quoted
from tests.interfaces_page import ROWS as VECTOR_ROWS
from tests.pair import HORIZONTAL_RECTI, pair_activations

N_BASES = 32
N_ITERATIONS = 4
# The last part of a name that is a quantity with a unit.
UNITS = {"deg": "deg", "m": "m", "w": "W", "rad": "rad", "s": "s", "px": "px", "n": "N"}
ALL_VECTORS = VECTORS | dict.fromkeys(("muscle_activations", "muscle_states"), MUSCLE_NAMES)
Sent = dict[str, list[JointState]]


def _rows() -> Iterator[tuple[str, str, list[str], str, str]]:
    """Yield (topic, field, names, unit, range) of each row of the page's vectors."""
    topic = field = ""
    names: list[str] = []
    for row in VECTOR_ROWS:
        if row[0]:
            topic, field = quoted(row[0])[0], "position"
        if row[1].startswith("as "):
            (field,) = quoted(row[1])
            names = list(ALL_VECTORS[topic])
        elif row[1] in (f"`{MUSCLE_NAMES[0]}` ... `{MUSCLE_NAMES[-1]}`", "the same muscles"):
            names = list(MUSCLE_NAMES)
        elif row[1].startswith("`"):
            names = quoted(row[1])
        else:
            names = list(VECTORS["episode"])
        yield topic, field, names, row[2], row[3]


ROWS = [row for row in _rows() if row[0] != "muscle_command" or "any muscle" not in row[2]]


def _is_within(values: np.ndarray, expected: str) -> bool:
    """Whether all values are in a range in the page's words, and finite unless it says NaN."""
    if expected.endswith("NaN"):
        values = values[~np.isnan(values)]
    words = expected.removesuffix("or NaN").replace(" n", f" {N_ITERATIONS}").split()
    least, most, above = -np.inf, np.inf, -np.inf
    match words:
        case []:
            pass
        case ["above", low]:
            above = float(low)
        case [low, "or", "more"]:
            least = float(low)
        case [high, "or", "less"]:
            most = float(high)
        case [low, "to", high]:
            least, most = float(low), float(high)
        case choices:
            return set(values.ravel()) <= {float(choice.strip(",")) for choice in choices}
    inside = (values >= least) & (values <= most) & (values > above)
    return bool((inside & np.isfinite(values)).all())


@pytest.fixture(scope="module", params=["k17", "anatomical"])
def sent(request: pytest.FixtureRequest, pictures: Path) -> Sent:
    """Return what a graph of either parameter set sends in training and in a test."""
    configuration: dict[str, dict[str, Any]] = {
        "task": {"n_bases": N_BASES},
        "eyes": {"mechanics.parameter_set": request.param},
        "eye_plant": {"stimuli.directory": str(pictures), "stimuli.size_px": 64},
    }
    loop = make_loop(configuration)
    messages = StepMessages(config_of(EyePlantConfig, configuration))
    found: Sent = defaultdict(list)
    for number in range(3):
        for step in loop.run_episode(_episode(number, phase=TEST if number == 2 else TRAINING)):
            for topic, message in messages.small(step.observation.number, step):
                if topic in ALL_VECTORS:
                    found[topic].append(read_vector(message, topic))
    loop.plant.close()
    return found


def _episode(number: int, phase: int) -> Episode:
    in_test = phase == TEST
    return Episode(
        phase=phase,
        test=0 if in_test else -1,
        trial=0 if in_test else -1,
        episode=min(number, 2),
        training_iteration=N_ITERATIONS * min(number, 2),
        stimulus=number,
        object_distance_m=1.0 + number,
        activations=pair_activations(0.04, 0.02),
        n_iterations=N_ITERATIONS,
        first_observation=(N_ITERATIONS + 1) * number,
    )


def test_every_vector_has_a_row_per_name() -> None:
    for topic, names in ALL_VECTORS.items():
        told = [n for t, field, row, _, _ in ROWS if (t, field) == (topic, "position") for n in row]
        own = told[len(VECTORS["episode"]) :] if topic == "ground_truth" else told
        assert own == list(names), topic
    assert all(row[4] for row in VECTOR_ROWS), "each has a meaning"


def test_names_and_fields_are_those_of_the_page(sent: Sent) -> None:
    assert sent.keys() == ALL_VECTORS.keys()
    for topic, vectors in sent.items():
        fields = {field for t, field, *_ in ROWS if t == topic}
        for vector in vectors:
            named = ALL_VECTORS[topic]
            assert vector.name[-len(named) :] == list(named)
            for field in ("position", "velocity", "effort"):
                expected = len(vector.name) if field in fields else 0
                assert len(getattr(vector, field)) == expected, (topic, field)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row[0]}.{row[1]} {row[2][0]}")
def test_what_is_sent_is_within_the_range_of_its_row(sent, row) -> None:
    topic, field, names, _, expected = row
    vectors = sent[topic]
    columns = [vectors[0].name.index(name) for name in names if name != "any muscle"]
    assert _is_within(np.array([np.array(getattr(v, field))[columns] for v in vectors]), expected)


def test_units_are_those_that_names_end_in() -> None:
    for topic, field, names, unit, _ in ROWS:
        if field == "position" and topic not in ("muscle_states", "eye_states"):
            assert {UNITS.get(name.rpartition("_")[2], "") for name in names} <= {unit}, names


def test_angles_are_in_radians_and_rates_in_watts(sent: Sent) -> None:
    for truth, eyes, muscles in zip(
        sent["ground_truth"], sent["eye_states"], sent["muscle_activations"], strict=True
    ):
        told = dict(zip(truth.name, truth.position, strict=True))
        adduction = [eyes.position[eyes.name.index(f"{s}_adduction")] for s in ("left", "right")]
        assert np.degrees(sum(adduction)) == pytest.approx(told["vergence_deg"], abs=1e-9)
        recti = [muscles.name.index(name) for name in HORIZONTAL_RECTI]
        assert np.array(muscles.effort)[recti].sum() == pytest.approx(told["metabolic_rate_w"])


def test_velocities_are_changes_per_second() -> None:
    eyes = Oculomotor(MechanicsConfig(parameter_set="anatomical"))
    eyes.settle(eyes.activations_from(0.1, 0.1))
    targets = eyes.activations_from(0.2, 0.05)
    eyes.advance(targets, 0.05)
    before, step_s = eyes.state(), 0.005
    eyes.advance(targets, step_s)
    after = eyes.state()
    turned = after.eye_angles_rad - before.eye_angles_rad
    paid_out = after.lengths_m - before.lengths_m
    for change, first, last in (
        (turned, before.eye_velocities_rad_s, after.eye_velocities_rad_s),
        (paid_out, before.velocities_m_s, after.velocities_m_s),
    ):
        mean = 0.5 * (first + last)
        np.testing.assert_allclose(change / step_s, mean, rtol=0.02, atol=0.02 * abs(mean).max())


def test_the_control_periods_and_the_size_of_pictures() -> None:
    periods = {s: MechanicsConfig(parameter_set=s).period_s for s in ("k17", "anatomical")}
    assert (
        f"({periods['k17']:g} s with `k17`, {periods['anatomical']:g} s with `anatomical`)" in PAGE
    )
    camera = CameraConfig()
    assert f"mono8, {camera.height_px} rows of {camera.width_px} px" in PAGE
