"""A film of a bag of three stages, read back frame by frame."""

import resource
from collections.abc import Callable
from pathlib import Path

import cv2
import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from active_binocular_vision.commands.bag import main
from active_binocular_vision.figures.style import VERMILION
from active_binocular_vision.film.frames import (
    HEADER_PX,
    PANEL_WIDTH_PX,
    Page,
    frames,
    shown_part,
)
from active_binocular_vision.film.scenes import Scene, scenes
from experiment_manager import Bag
from experiment_manager.bag.writer import BagWriter
from eye_plant.mechanics.mujoco_model import MechanicsConfig
from lockstep.command_space import MUSCLE_NAMES
from lockstep.wire.topics import EYE_STATE_NAMES, GROUND_TRUTH_NAMES, PICTURES, TEST, TRAINING
from tests.config_text import config_text
from tests.readable import assert_readable

PERIOD_NS = 100_000_000
VECTOR, IMAGE = "sensor_msgs/msg/JointState", "sensor_msgs/msg/Image"
N_ITERATIONS = 12
ACTIVATIONS = tuple(0.01 * (1 + i) for i in range(12))
EYE_ANGLES_RAD = (0.1, 0.0, 0.0, 0.2, 0.0, 0.0)
# Enlarged twice to the width of a panel.
HEIGHT, WIDTH = 64, 120


def _grey(episode: int, iteration: int, side: int) -> int:
    return 40 + 50 * episode + 8 * iteration + 20 * side


OF_TWELVE = {
    "command_space": "all_muscles",
    "lowest_activations": [0.0],
    "highest_activations": [0.2],
}
TWELVE = config_text(task=OF_TWELVE)


@pytest.fixture
def bag(tmp_path, vector_bytes, image_bytes) -> Path:
    """Three episodes of 12 observations with pictures: a trial, a training episode, a trial."""
    return _write(tmp_path / "bag", vector_bytes, image_bytes)


OWN_TARGETS = config_text(
    task=OF_TWELVE
    | {"fixation_iterations": 6, "iterations_per_episode": 12, "iterations_per_trial": 12}
    | {"n_training_iterations": 12},
    experiment_manager={"gives_targets": False, "test_iterations": [0]},
)


@pytest.fixture
def bag_of_twelve(tmp_path, vector_bytes, image_bytes) -> Path:
    """The same with a command for each muscle."""
    return _write(tmp_path / "twelve", vector_bytes, image_bytes, configuration=TWELVE)


def _write(
    path: Path,
    vector_bytes: Callable[..., bytes],
    image_bytes: Callable[..., bytes],
    configuration: str = config_text(),
) -> Path:
    topics = dict.fromkeys(("ground_truth", "muscle_activations", "eye_states"), VECTOR)
    topics |= dict.fromkeys(PICTURES, IMAGE)
    with BagWriter(
        path, topics, {"model": "M", "seed": "1"}, configuration=configuration
    ) as writer:
        for episode, (phase, training) in enumerate(((TEST, 0), (TRAINING, 500), (TEST, 1000))):
            for iteration in range(N_ITERATIONS):
                stamp_ns = (episode * N_ITERATIONS + iteration) * PERIOD_NS
                values = dict.fromkeys(GROUND_TRUTH_NAMES, 0.0) | {
                    "phase": phase,
                    "iteration": iteration,
                    "training_iteration": training,
                    "vergence_error_deg": 2.0 - 0.1 * iteration,
                    "vertical_error_deg": -1.0,
                    "cyclovergence_error_deg": 3.0,
                    "metabolic_rate_w": 1.5,
                }
                truth = vector_bytes(tuple(values), tuple(values.values()), stamp_ns)
                writer.write("ground_truth", truth, stamp_ns)
                activations = vector_bytes(MUSCLE_NAMES, ACTIVATIONS, stamp_ns)
                writer.write("muscle_activations", activations, stamp_ns)
                eyes = vector_bytes(EYE_STATE_NAMES[:4], EYE_ANGLES_RAD[:4], stamp_ns)
                writer.write("eye_states", eyes, stamp_ns)
                for side, topic in enumerate(PICTURES):
                    picture = np.full((HEIGHT, WIDTH), _grey(episode, iteration, side), np.uint8)
                    writer.write(topic, image_bytes(picture, stamp_ns), stamp_ns)
        writer.commit()
    return path


def _frames_of_mp4(file: Path) -> list[np.ndarray]:
    video = cv2.VideoCapture(str(file))
    found: list[np.ndarray] = []
    while True:
        there, frame = video.read()
        if not there:
            return found
        found.append(cv2.cvtColor(frame, cv2.COLOR_BGR2RGB))


def test_between_two_frames_figures_are_drawn_as_their_owner_wants(bag: Path) -> None:
    drawn = frames(scenes(Bag(bag)))
    with mpl.rc_context({"font.size": 20.0}):
        for _ in range(2):
            next(drawn)
            assert mpl.rcParams["font.size"] == 20.0


# Ten iterations of each of three scenes; each ends with four periods of its last.
N_FRAMES = 3 * (10 + 3)


def test_an_mp4_shows_pictures_and_growing_curves_of_each_iteration(bag: Path) -> None:
    file = bag.parent / "film.mp4"
    assert main([str(bag), "--film", str(file)]) == 0
    frames = _frames_of_mp4(file)
    assert len(frames) == N_FRAMES
    for number, (episode, iteration) in {0: (0, 0), 9: (0, 9), 12: (0, 9), 13: (1, 0)}.items():
        left, right = _grey(episode, iteration, 0), _grey(episode, iteration, 1)
        columns = [PANEL_WIDTH_PX // 2 + i * PANEL_WIDTH_PX for i in range(3)]
        found = [frames[number][HEADER_PX + HEIGHT, column].tolist() for column in columns]
        expected = [[left] * 3, [right] * 3, [left, right, right]]
        np.testing.assert_allclose(found, expected, atol=6)  # the film is compressed
    curves = slice(HEADER_PX + 2 * HEIGHT, None)
    n_dark = [int((frames[number][curves].max(axis=-1) < 240).sum()) for number in (0, 9)]
    assert n_dark[1] > n_dark[0] + 200


def test_a_page_has_the_eyes_each_error_and_text_that_can_be_read(bag_of_twelve: Path) -> None:
    (*_, shown) = scenes(Bag(bag_of_twelve))
    assert shown.errors_deg[4].tolist() == pytest.approx([1.6, -1.0, 3.0])
    assert shown.activations[4].tolist() == list(ACTIVATIONS)
    assert shown.eye_angles_rad[4].tolist() == list(EYE_ANGLES_RAD)
    page = Page([shown])
    page.draw(shown, 4)
    errors = page.figure.axes[-1]
    ends_deg = {line.get_label(): np.asarray(line.get_ydata())[-1] for line in errors.get_lines()}
    assert ends_deg == pytest.approx({"vergence": 1.6, "vertical": -1.0, "cyclovergence": 3.0})
    assert_readable(page.figure)


def test_a_page_of_the_pair_says_where_vergence_is_and_what_it_costs(bag: Path) -> None:
    (shown, *_) = scenes(Bag(bag))
    page = Page([shown])
    page.draw(shown, 4)
    (caption, *_) = page.figure.texts
    assert caption.get_text() == (
        "before learning: vergence error +1.60 deg (+7.2 px), metabolic rate 1.50 W"
    )
    assert_readable(page.figure)


def test_the_middle_of_a_picture_fills_a_panel() -> None:
    picture = np.arange(240 * 320).reshape(240, 320)
    assert np.array_equal(shown_part(picture), picture[30:210, 40:280])
    assert np.array_equal(
        shown_part(picture[:64, :120]), picture[:64, :120].repeat(2, 0).repeat(2, 1)
    )


def assert_anaglyph_is_red_and_cyan(frame: np.ndarray) -> None:
    """Of the first frame of the bag, whatever colours a GIF has."""
    left, right = (_grey(0, 0, side) for side in (0, 1))
    found = frame[HEADER_PX + HEIGHT, PANEL_WIDTH_PX * 5 // 2]
    np.testing.assert_allclose(found, [left, right, right], atol=3)


@pytest.mark.parametrize(("rate", "frame_ms"), [((), 200), (("--rate", "0.25"), 400)])
def test_a_gif_has_the_last_of_each_scene_for_a_while(bag, rate, frame_ms, capsys) -> None:
    file = bag.parent / "film.gif"
    assert main([str(bag), "--film", str(file), *rate]) == 0
    assert f", {N_FRAMES * frame_ms / 1000:.0f} s" in capsys.readouterr().out
    with Image.open(file) as gif:
        assert gif.width == 3 * PANEL_WIDTH_PX
        assert_anaglyph_is_red_and_cyan(np.asarray(gif.convert("RGB")))
        durations_ms = []
        for i_frame in range(gif.n_frames):  # type: ignore[attr-defined]
            gif.seek(i_frame)
            durations_ms.append(gif.info["duration"])
    assert durations_ms == ([frame_ms] * 9 + [4 * frame_ms]) * 3


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("film.avi", "expected a file that ends in .mp4 or .gif"),
        ("there.gif", "expected a new file"),
        ("nowhere/film.gif", "No such file or directory"),
        ("nowhere/film.mp4", "cannot be written as a VP9 film"),
    ],
)
def test_a_file_that_cannot_be_is_one_error(bag, name, message, capsys) -> None:
    (bag.parent / "there.gif").touch()
    before = sorted(bag.parent.rglob("*"))
    assert main([str(bag), "--film", str(bag.parent / name)]) == 2
    assert message in capsys.readouterr().err
    assert sorted(bag.parent.rglob("*")) == before


def test_an_mp4_that_the_disk_cuts_short_is_one_error_and_not_left(bag, capsys) -> None:
    before = sorted(bag.parent.rglob("*"))
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        assert main([str(bag), "--film", str(bag.parent / "film.mp4")]) == 2
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert f"expected a film of {N_FRAMES} frames, got 0" in capsys.readouterr().err
    assert sorted(bag.parent.rglob("*")) == before


def test_a_bag_without_pictures_is_one_error(make_bag, capsys) -> None:
    bag = make_bag({"/ground_truth": (GROUND_TRUTH_NAMES, np.zeros((3, len(GROUND_TRUTH_NAMES))))})
    assert main([str(bag), "--film", str(bag.parent / "film.gif")]) == 2
    assert "expected images of both eyes, it has none" in capsys.readouterr().err


def test_training_without_given_targets_has_none_to_ring(
    tmp_path, vector_bytes, image_bytes
) -> None:
    bag = _write(tmp_path / "own", vector_bytes, image_bytes, configuration=OWN_TARGETS)
    assert [scene.targets_deg is None for scene in scenes(Bag(bag))] == [False, True, False]


def test_the_gaze_target_is_ringed_in_the_left_picture() -> None:
    n, px_deg = 2, 0.25
    targets_deg = np.array([[5.0 * px_deg, 10.0 * px_deg], [0.0, 0.0]])
    scene = Scene(
        "a fixation",
        np.full((n, 2, HEIGHT, WIDTH), 90, np.uint8),
        np.zeros((n, 3)),
        np.ones(n),
        np.zeros((n, 6)),
        np.full((n, 12), 0.1),
        MechanicsConfig(),
        px_deg,
        targets_deg,
    )
    page, colour = Page([scene]), [round(255 * part) for part in to_rgb(VERMILION)]
    for iteration, (right, up) in enumerate(((10, 20), (0, 0))):
        frame = page.draw(scene, iteration)
        rows, columns = np.nonzero((frame[HEADER_PX : HEADER_PX + 2 * HEIGHT] == colour).all(2))
        assert rows.mean() == pytest.approx(HEIGHT - up, abs=1.0)
        assert columns.mean() == pytest.approx(WIDTH + right, abs=1.0)
