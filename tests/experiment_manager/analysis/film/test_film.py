"""A film of a bag of three stages, read back frame by frame."""

from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from experiment_manager.bag.writer import BagWriter
from experiment_manager.commands.inspect_bag import main
from lockstep.wire.topics import GROUND_TRUTH_NAMES, HORIZONTAL_RECTI, PICTURES, TEST, TRAINING

PERIOD_NS = 100_000_000
VECTOR, IMAGE = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Image"
N_ITERATIONS = 12
HEIGHT, WIDTH = 64, 120
# Of the frame: a caption, then left, right and anaglyph side by side.
CAPTION_PX = 28


def _grey(episode: int, iteration: int, side: int) -> int:
    return 40 + 50 * episode + 8 * iteration + 20 * side


@pytest.fixture
def bag(
    tmp_path: Path, vector_bytes: Callable[..., bytes], image_bytes: Callable[..., bytes]
) -> Path:
    """Three episodes of 12 observations with pictures: a trial, a training episode, a trial."""
    topics = {"ground_truth": VECTOR, "muscle_activations": VECTOR} | dict.fromkeys(PICTURES, IMAGE)
    with BagWriter(tmp_path / "bag", topics, {"model": "M", "seed": "1"}) as writer:
        for episode, (phase, training) in enumerate(((TEST, 0), (TRAINING, 500), (TEST, 1000))):
            for iteration in range(N_ITERATIONS):
                stamp_ns = (episode * N_ITERATIONS + iteration) * PERIOD_NS
                values = dict.fromkeys(GROUND_TRUTH_NAMES, 0.0) | {
                    "phase": phase,
                    "iteration": iteration,
                    "training_iteration": training,
                    "vergence_error_deg": 2.0 - 0.1 * iteration,
                }
                truth = vector_bytes(tuple(values), tuple(values.values()), stamp_ns)
                writer.write("ground_truth", truth, stamp_ns)
                muscles = vector_bytes(HORIZONTAL_RECTI, (0.1, 0.05, 0.1, 0.05), stamp_ns)
                writer.write("muscle_activations", muscles, stamp_ns)
                for side, topic in enumerate(PICTURES):
                    picture = np.full((HEIGHT, WIDTH), _grey(episode, iteration, side), np.uint8)
                    writer.write(topic, image_bytes(picture, stamp_ns), stamp_ns)
        writer.commit()
    return tmp_path / "bag"


def _frames_of_mp4(file: Path) -> list[np.ndarray]:
    video = cv2.VideoCapture(str(file))
    frames: list[np.ndarray] = []
    while True:
        there, frame = video.read()
        if not there:
            return frames
        frames.append(cv2.cvtColor(frame, cv2.COLOR_BGR2RGB))


# Ten iterations of each of three scenes; each ends with four periods of its last.
N_FRAMES = 3 * (10 + 3)


def test_an_mp4_shows_pictures_and_growing_curves_of_each_iteration(bag: Path) -> None:
    file = bag.parent / "film.mp4"
    assert main([str(bag), "--film", str(file)]) == 0
    frames = _frames_of_mp4(file)
    assert len(frames) == N_FRAMES
    for number, (episode, iteration) in {0: (0, 0), 9: (0, 9), 12: (0, 9), 13: (1, 0)}.items():
        left, right = _grey(episode, iteration, 0), _grey(episode, iteration, 1)
        middle = CAPTION_PX + HEIGHT // 2
        found = [frames[number][middle, WIDTH // 2 + i * WIDTH].tolist() for i in range(3)]
        expected = [[left] * 3, [right] * 3, [left, right, right]]
        np.testing.assert_allclose(found, expected, atol=6)  # the film is compressed
    curves = slice(CAPTION_PX + HEIGHT, None)
    n_dark = [int((frames[number][curves].max(axis=-1) < 240).sum()) for number in (0, 9)]
    assert n_dark[1] > n_dark[0] + 200


def test_a_gif_is_half_as_wide_and_holds_the_last_of_each_scene(bag: Path) -> None:
    file = bag.parent / "film.gif"
    assert main([str(bag), "--film", str(file)]) == 0
    with Image.open(file) as gif:
        assert gif.width == 3 * WIDTH // 2
        durations_ms = []
        for i_frame in range(gif.n_frames):  # type: ignore[attr-defined]
            gif.seek(i_frame)
            durations_ms.append(gif.info["duration"])
    assert durations_ms == ([200] * 9 + [800]) * 3


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("film.avi", "expected a file that ends in .mp4 or .gif"),
        ("there.gif", "expected a new file"),
        ("nowhere/film.gif", "No such file or directory"),
        ("nowhere/film.mp4", "cannot be written as a VP9 film"),
    ],
)
def test_a_file_that_cannot_be_is_one_error(
    bag: Path, name: str, message: str, capsys: pytest.CaptureFixture[str]
) -> None:
    (bag.parent / "there.gif").touch()
    before = sorted(bag.parent.rglob("*"))
    assert main([str(bag), "--film", str(bag.parent / name)]) == 2
    assert message in capsys.readouterr().err
    assert sorted(bag.parent.rglob("*")) == before


def test_a_bag_without_pictures_is_one_error(
    make_bag: Callable[..., Path], capsys: pytest.CaptureFixture[str]
) -> None:
    bag = make_bag({"/ground_truth": (GROUND_TRUTH_NAMES, np.zeros((3, len(GROUND_TRUTH_NAMES))))})
    assert main([str(bag), "--film", str(bag.parent / "film.gif")]) == 2
    assert "expected pictures of both eyes, it has none" in capsys.readouterr().err
