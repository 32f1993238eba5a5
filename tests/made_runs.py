"""Serialized messages of the graph's topics, and bags of them, for the tests of this package."""

import math
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.typesys import Stores, get_typestore

from active_binocular_vision.commands.run import main as run_experiment
from experiment_manager.bag.writer import BagWriter
from experiment_manager.run.config_file import text_of_continuation
from experiment_manager.sections import DEFAULTS
from lockstep.wire.topics import GROUND_TRUTH_NAMES, reward_names
from tests.command_lines import set_words
from tests.made_once import made_once
from tests.supervisor import finished, start_supervisor

VECTOR = "sensor_msgs/msg/JointState"
IMAGE = "sensor_msgs/msg/Image"
PERIOD_NS = 100_000_000
STIMULUS_PX = 64

VectorBytes = Callable[..., bytes]
ImageBytes = Callable[[np.ndarray, int], bytes]


# Not rclpy's serialize_message: that one returns a few bytes too many, which no wire carries.
_STORE = get_typestore(Stores.ROS2_JAZZY)
_HEADER = _STORE.types["std_msgs/msg/Header"]
_TIME = _STORE.types["builtin_interfaces/msg/Time"]


def _header(stamp_ns: int, frame: str) -> Any:
    return _HEADER(_TIME(*divmod(stamp_ns, 1_000_000_000)), frame)


def _vector_bytes(
    names: Sequence[str],
    position: Sequence[float],
    stamp_ns: int = 0,
    velocity: Sequence[float] = (),
    effort: Sequence[float] = (),
) -> bytes:
    numbers = [np.array(values, dtype=np.float64) for values in (position, velocity, effort)]
    message = _STORE.types[VECTOR](_header(stamp_ns, ""), list(names), *numbers)
    return bytes(_STORE.serialize_cdr(message, VECTOR))


def _image_bytes(picture: np.ndarray, stamp_ns: int) -> bytes:
    height, width = picture.shape
    encoding = {"uint8": "mono8", "float32": "32FC1"}[picture.dtype.name]
    data = np.frombuffer(picture.tobytes(), np.uint8)
    message = _STORE.types[IMAGE](
        _header(stamp_ns, "left_eye"), height, width, encoding, 0, width * picture.itemsize, data
    )
    return bytes(_STORE.serialize_cdr(message, IMAGE))


@pytest.fixture
def vector_bytes() -> VectorBytes:
    """Return a function that serializes a JointState."""
    return _vector_bytes


@pytest.fixture
def image_bytes() -> ImageBytes:
    """Return a function that serializes an Image."""
    return _image_bytes


@pytest.fixture
def make_bag(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes vectors {topic: (names, values (n, k))} into a new bag."""

    def write(
        tables: Mapping[str, tuple[Sequence[str], np.ndarray]], name: str = "bag", n_files: int = 1
    ) -> Path:
        directory = tmp_path / name
        topics = dict.fromkeys(tables, VECTOR)
        with BagWriter(directory, topics, {"model": "M", "seed": "1"}) as writer:
            n_rows = max(len(values) for _, values in tables.values())
            for row in range(n_rows):
                for topic, (names, values) in tables.items():
                    if row < len(values):
                        stamp_ns = row * PERIOD_NS
                        writer.write(topic, _vector_bytes(names, values[row], stamp_ns), stamp_ns)
                if (row + 1) % -(-n_rows // n_files) == 0:
                    writer.commit()
        return directory

    return write


_SIDES_AND_MUSCLES = (
    "left_medial_rectus",
    "left_lateral_rectus",
    "right_medial_rectus",
    "right_lateral_rectus",
)


def _vergence_deg(medial: float, lateral: float) -> float:
    """Both eyes' adduction, about as in K17's plant near rest."""
    return 2.0 * (0.498 + 37.7 * medial - 40.9 * lateral)


def _cost_w(medial: float, lateral: float) -> float:
    """Both eyes' metabolic rate, about as in K17's plant."""
    floor = 0.005
    return 2.0 * (2.229 * max(medial, floor) ** 0.6 + 2.03 * max(lateral, floor) ** 0.6)


def _desired_deg(distance_m: float) -> float:
    return math.degrees(2.0 * math.atan(0.056 / (2.0 * distance_m)))


def _optimal_w(distance_m: float) -> float:
    needed = _desired_deg(distance_m) / 2.0 - 0.498
    return _cost_w(max(needed, 0.0) / 37.7, max(-needed, 0.0) / 40.9)


def config_text(model: str, seed: int, n_iterations: int, weight: float, **task: Any) -> str:
    """Return the config.yaml of a run with default settings, except those of the task given."""
    configuration = {section: dict(values) for section, values in DEFAULTS.items()}
    configuration["task"] |= task | {
        "seed": seed,
        "n_training_iterations": n_iterations,
        "metabolic_cost_weight": weight,
    }
    configuration["experiment_manager"] |= {"model": model, "commit": "0123abc"}
    versions = ["mujoco 4.0.0", "numpy 2.4.6"]
    return text_of_continuation("", configuration, {"versions": versions})


class SyntheticRun:
    """Writes a run as if its learner were the better the longer it trained."""

    def __init__(
        self, directory: Path, model: str, seed: int, n_iterations: int, n_stimuli: int
    ) -> None:
        self.directory = directory
        self._model, self._seed, self._n_iterations = model, seed, n_iterations
        self._n_stimuli = n_stimuli
        self._rng = np.random.default_rng(seed)
        self._observation = 0
        weight = 0.08 if model == "M_C" else 0.0
        text = config_text(model, seed, n_iterations, weight)
        topics = {
            "ground_truth": VECTOR,
            "reward": VECTOR,
            "muscle_activations": VECTOR,
            "left/image_raw": IMAGE,
            "right/image_raw": IMAGE,
        }
        metadata = {"model": model, "seed": str(seed)}
        self._writer = BagWriter(directory / "bag", topics, metadata, configuration=text)
        self._picture = self._texture()

    def write(self, n_tests: int = 4) -> Path:
        """Train with tests at equal distances from 0 to the end; return the run directory."""
        with self._writer:
            for test in range(n_tests):
                at = round(test / (n_tests - 1) * self._n_iterations / 10) * 10
                self._test(test, at)
                following = round((test + 1) / (n_tests - 1) * self._n_iterations / 10) * 10
                if test < n_tests - 1:
                    for episode in range(at // 10, following // 10):
                        distance_m = float(self._rng.uniform(0.5, 6.0))
                        start_deg = _desired_deg(float(self._rng.uniform(0.5, 6.0)))
                        self._episode(
                            10,
                            distance_m,
                            start_deg,
                            {"phase": 0, "test": -1, "trial": -1},
                            episode * 10,
                        )
                self._writer.commit()
        return self.directory

    def _test(self, test: int, at: int) -> None:
        trial = 0
        for stimulus in range(self._n_stimuli):
            for distance_m in (0.5, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0):
                desired_deg = _desired_deg(distance_m)
                for error_deg in range(-3, math.floor(desired_deg) + 1):
                    names = {"phase": 1, "test": test, "trial": trial, "stimulus": 100 + stimulus}
                    self._episode(20, distance_m, desired_deg - error_deg, names, at)
                    trial += 1

    def _episode(
        self, n: int, distance_m: float, start_deg: float, names: Mapping[str, float], trained: int
    ) -> None:
        skill = min(1.0, trained / (0.4 * self._n_iterations)) if self._n_iterations else 0.0
        low = max(0.0, (0.498 - start_deg / 2.0) / 40.9)
        lateral = float(self._rng.uniform(low, 0.1))
        medial = (start_deg / 2.0 - 0.498 + 40.9 * lateral) / 37.7
        first_w = _cost_w(medial, lateral)
        wander_deg = 0.08 + 1.5 * (1 - skill)
        for i in range(n + 1):
            error_deg = _desired_deg(distance_m) - _vergence_deg(medial, lateral)
            values = (
                dict.fromkeys(GROUND_TRUTH_NAMES, 0.0)
                | dict(names)
                | {
                    "iteration": i,
                    "training_iteration": trained + (i if names["phase"] == 0 else 0),
                    "observation": self._observation,
                    "object_distance_m": distance_m,
                    "vergence_deg": _vergence_deg(medial, lateral),
                    "desired_vergence_deg": _desired_deg(distance_m),
                    "vergence_error_deg": error_deg,
                    "metabolic_rate_w": _cost_w(medial, lateral),
                    "initial_metabolic_rate_w": first_w,
                    "optimal_metabolic_rate_w": _optimal_w(distance_m),
                }
            )
            self._publish(values, medial, lateral, error_deg, skill, answered=i < n)
            wanted_deg = (0.85 * skill * error_deg) + float(self._rng.normal(0, wander_deg)) * 0.5
            medial += wanted_deg / 4 / 37.7
            lateral -= wanted_deg / 4 / 40.9
            if self._model == "M_C":
                saved = 0.15 * skill * min(medial, lateral)
                medial, lateral = medial - saved, lateral - saved * 37.7 / 40.9
            medial, lateral = min(max(medial, 0.0), 0.2), min(max(lateral, 0.0), 0.1)
            self._observation += 1

    def _publish(
        self,
        values: dict[str, float],
        medial: float,
        lateral: float,
        error_deg: float,
        skill: float,
        *,
        answered: bool,
    ) -> None:
        stamp_ns = self._observation * PERIOD_NS
        truth = _vector_bytes(list(values), list(values.values()), stamp_ns)
        self._writer.write("ground_truth", truth, stamp_ns)
        activations = _vector_bytes(_SIDES_AND_MUSCLES, [medial, lateral] * 2, stamp_ns)
        self._writer.write("muscle_activations", activations, stamp_ns)
        if not answered:
            return
        half = 0.22 - 0.13 * skill * math.exp(-(error_deg**2)) + float(self._rng.normal(0, 0.01))
        weight = 0.08 if self._model == "M_C" else 0.0
        cost_w = values["metabolic_rate_w"]
        penalty, number = weight * cost_w, float(self._observation)
        parts = [half, half, cost_w, penalty, -2 * half - penalty, number]
        self._writer.write("reward", _vector_bytes(reward_names(), parts, stamp_ns), stamp_ns)
        if values["phase"] == 1 and values["trial"] % 10 == 0:
            shift_px = error_deg / 0.2226 / 2
            for side, sign in (("left", 1), ("right", -1)):
                moved = np.roll(self._picture, round(sign * shift_px), axis=1)
                picture = _image_bytes(moved[:, 80:400], stamp_ns)
                self._writer.write(f"{side}/image_raw", picture, stamp_ns)

    def _texture(self) -> np.ndarray:
        """Overlapping grey rectangles, 240 x 480."""
        picture = np.full((240, 480), 128, np.uint8)
        for _ in range(150):
            top, first = self._rng.integers(0, 220), self._rng.integers(0, 460)
            height, width = self._rng.integers(5, 60, 2)
            picture[top : top + height, first : first + width] = self._rng.integers(20, 235)
        return picture


@pytest.fixture(scope="session")
def run_directories(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Two small runs, of M and of M_C: {model: run directory}."""
    parent = tmp_path_factory.mktemp("runs")
    return {
        model: SyntheticRun(parent / model, model, 1, n_iterations=400, n_stimuli=1).write()
        for model in ("M", "M_C")
    }


@pytest.fixture(scope="session")
def small_run(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Path:
    """A whole run through the graph: 60 training iterations, three tests, every picture recorded.

    Other tests copy it before they change anything.
    """
    settings = {
        "experiment_manager.test_distances_m": "[2.0]",
        "task.iterations_per_trial": "4",
        "experiment_manager.pictures_every_n_episodes": "1",
        "experiment_manager.pictures_every_n_trials": "1",
        "eye_plant.stimuli.size_px": str(STIMULUS_PX),
        "vergence_rl.cacla.output_initial_width": "0.1",
    }
    line = ["--iterations", "60", "--tests", "0,30", "--stimuli", str(pictures)]
    line += set_words(settings)

    def make(directory: Path) -> None:
        finished(start_supervisor([*line, "--out", str(directory / "run")]))

    return made_once(tmp_path_factory, "small", make) / "run"


@pytest.fixture(scope="session")
def run_of(tmp_path_factory: pytest.TempPathFactory, pictures: Path) -> Callable[[str], Path]:
    """Return a function that returns the run directory of a kind of eyes, hardly trained.

    The pair and twelve muscles without saccades, and those with; tests before and after training.
    """

    def run(kind: str) -> Path:
        settings = {
            "eye_plant.stimuli.size_px": STIMULUS_PX,
            "experiment_manager.test_distances_m": "[2.0]",
            "task.n_bases": 32,
        }
        if kind != "pair":
            settings["experiment_manager.n_starts_per_distance"] = 1
        line = ["--in-process", "--profile", {"pair": "precise"}.get(kind, kind)]
        line += ["--iterations", "40", "--tests", "0,40", "--stimuli", str(pictures)]
        line += set_words(settings)

        def make(directory: Path) -> None:
            # What a test reads of standard output is its own.
            with redirect_stdout(sys.stderr):
                assert run_experiment([*line, "--out", str(directory / "run")]) == 0

        return made_once(tmp_path_factory, f"eyes_{kind}", make) / "run"

    return run


@pytest.fixture(scope="session")
def gazing_run(run_of: Callable[[str], Path]) -> Path:
    """Return the directory of a run of eyes that make saccades, hardly trained."""
    return run_of("gaze")
