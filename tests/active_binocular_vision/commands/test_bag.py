"""inspect_bag: what it prints, repairs and takes out."""

import os
import subprocess
import sys
from pathlib import Path

import cv2
import numpy as np
import pytest
import yaml
from rosbags.highlevel import AnyReader

from active_binocular_vision.commands.bag import main
from experiment_manager import Bag
from experiment_manager.bag.mcap_file import McapFile
from experiment_manager.bag.writer import BagWriter
from lockstep.wire.topics import GROUND_TRUTH_NAMES, TEST
from tests.config_text import config_text
from tests.patience import PATIENCE_S

VECTOR = "sensor_msgs/msg/JointState"
IMAGE = "sensor_msgs/msg/Image"
PERIOD_NS = 100_000_000


CONFIGURATION = config_text(task={"iterations_per_trial": 2})


@pytest.fixture
def bag(tmp_path, vector_bytes, image_bytes, monkeypatch) -> Path:
    """A bag of two files and many chunks: 30 trials of two iterations, pictures of some."""
    monkeypatch.setattr("experiment_manager.bag.writer._CHUNK_BYTES", 5000)
    topics = {"ground_truth": VECTOR, "left/image_raw": IMAGE, "features": IMAGE}
    rng = np.random.default_rng(0)
    metadata = {"model": "M", "seed": "11"}
    with BagWriter(tmp_path / "bag", topics, metadata, configuration=CONFIGURATION) as writer:
        for observation in range(90):
            trial, iteration = divmod(observation, 3)
            values = dict.fromkeys(GROUND_TRUTH_NAMES, 1.0) | {
                "phase": TEST,
                "trial": trial,
                "iteration": iteration,
                "training_iteration": 4000,
                "vergence_error_deg": 2.0 - iteration * 0.75,
            }
            stamp_ns = observation * PERIOD_NS + (observation >= 45) * 5 * PERIOD_NS
            vector = vector_bytes(list(values), list(values.values()), stamp_ns)
            writer.write("ground_truth", vector, stamp_ns)
            if observation in (3, 4):
                picture = rng.integers(0, 256, (24, 32), dtype=np.uint8)
                writer.write("left/image_raw", image_bytes(picture, stamp_ns), stamp_ns)
                features = np.array([[0.0, 0.5], [1.0, 2.0]], np.float32)
                writer.write("features", image_bytes(features, stamp_ns), stamp_ns)
            if observation == 44:
                writer.commit()
    return tmp_path / "bag"


def _messages(bag: Path) -> list[tuple[str, int, bytes]]:
    with AnyReader([bag]) as reader:
        return [(c.topic, t, raw) for c, t, raw in reader.messages()]


def _words(text: str) -> dict[str, list[str]]:
    """Return the words of each line by its first."""
    return {words[0]: words for words in map(str.split, text.splitlines()) if words}


def test_it_prints_topics_run_and_learning_curve(bag, capsys) -> None:
    assert main([str(bag.parent)]) == 0, "a run directory does as well"
    text = capsys.readouterr().out
    lines = _words(text)
    assert "2 files" in text
    assert "whole" in text
    # 90 messages in 89 + 5 periods of 0.1 s; one gap of six periods.
    assert lines["/ground_truth"] == ["/ground_truth", VECTOR, "90", "9.47", "1", "0.6"]
    assert lines["/left/image_raw"] == ["/left/image_raw", IMAGE, "2", "-", "-", "-"]
    assert "seed: 11" in text
    assert text.index("4000 ") < text.index("/ground_truth"), "the learning curve comes first"
    assert CONFIGURATION not in text
    assert main([str(bag.parent), "--configuration"]) == 0
    assert f"\nconfig.yaml:\n\n{CONFIGURATION}" in capsys.readouterr().out
    assert lines["4000"][:6] == ["4000", "30", "0.500", "0.000", "0.0", "%"]


def test_pictures_are_taken_out(bag: Path, tmp_path: Path) -> None:
    assert main([str(bag), "--extract", str(tmp_path / "pictures")]) == 0
    expected = dict(Bag(bag).images("left/image_raw"))
    assert sorted(expected) == [3 * PERIOD_NS, 4 * PERIOD_NS]
    for stamp_ns, picture in expected.items():
        path = tmp_path / "pictures" / "left" / "image_raw" / f"{stamp_ns:019d}.png"
        taken_out = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        assert taken_out is not None
        assert np.array_equal(taken_out, picture)
    features = tmp_path / "pictures" / "features" / f"{3 * PERIOD_NS:019d}.png"
    grey = cv2.imread(str(features), cv2.IMREAD_UNCHANGED)
    assert grey is not None
    assert grey.tolist() == [[0, 64], [128, 255]]


def test_pictures_never_overwrite(bag, tmp_path, capsys) -> None:
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "mine.png").write_text("")
    assert main([str(bag), "--extract", str(tmp_path / "pictures")]) == 2
    assert "error: expected a new or empty directory for images" in capsys.readouterr().err


def test_a_rate_that_is_none_is_one_line(tmp_path: Path, capsys) -> None:
    assert main([str(tmp_path), "--film", "film.gif", "--rate", "0"]) == 2
    assert capsys.readouterr().err == "error: --rate: expected more than 0, got 0\n"


def test_what_is_no_bag_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([str(tmp_path / "none")]) == 2
    error = capsys.readouterr().err
    assert error.startswith("error: expected a bag directory or an .mcap file")
    assert error.count("\n") == 1


def _overwritten(path: Path, start: int, n_bytes: int) -> None:
    noise = np.random.default_rng(5).integers(0, 256, n_bytes, dtype=np.uint8).tobytes()
    content = path.read_bytes()
    path.write_bytes(content[:start] + noise + content[start + n_bytes :])


@pytest.mark.parametrize(
    ("broken", "share", "lost"),
    [
        ((), 0.0, None),
        ((), 0.001, None),
        ((), 0.5, None),
        ((), 0.999, ()),
        ((1,), 1.0, (1,)),
        ((0, 2), 1.0, (0, 2)),
        ((1,), 0.999, (1,)),
        # The first chunk announces the topics; in a cut-off file nothing else does.
        ((0,), 0.5, None),
    ],
)
def test_a_repaired_bag_is_whole_and_has_each_chunk_that_can_be_read(
    bag, broken, share, lost, capsys
) -> None:
    """Broken: numbers of chunks; share: of the file that is left; lost: chunks, None for most."""
    messages, path = _messages(bag), bag / "bag_1.mcap"
    file, content = McapFile(path), path.read_bytes()
    chunks = file.chunks("/ground_truth")
    stamps_ns = [set(file.index(chunk, "/ground_truth")[:, 0].tolist()) for chunk in chunks]
    for i in broken:
        _overwritten(path, chunks[i].chunk_start_offset + 60, 20)
    path.write_bytes(path.read_bytes()[: int(share * len(content))])
    if lost is None:
        ends = [c.chunk_start_offset + c.chunk_length for c in chunks]
        whole = [] if broken else [i for i, end in enumerate(ends) if end <= share * len(content)]
        lost = {*range(len(chunks))} - {*whole}
    lost_ns = set().union(*(stamps_ns[i] for i in lost))
    expected = [row for row in messages if row[1] not in lost_ns]
    before = Bag(bag).stamps_ns("ground_truth").tolist() if share < 1.0 else None

    assert main([str(bag), "--repair"]) == 0
    n_kept = len(set().union(*stamps_ns) - lost_ns)
    assert f"bag_1.mcap: {n_kept} messages kept, " in capsys.readouterr().out
    assert _messages(bag) == expected
    if before is not None:
        assert Bag(bag).stamps_ns("ground_truth").tolist() == before
    information = yaml.safe_load((bag / "metadata.yaml").read_text())["rosbag2_bagfile_information"]
    assert information["message_count"] == len(expected)
    assert information["custom_data"] == {"model": "M", "seed": "11"}
    assert main([str(bag), "--repair"]) == 0
    assert "nothing to repair" in capsys.readouterr().out


def test_repairing_makes_a_broken_index_again(bag: Path, capsys) -> None:
    expected, path = _messages(bag), bag / "bag_1.mcap"
    chunk = McapFile(path).chunks("/ground_truth")[1]
    # The index of a chunk's messages follows it.
    _overwritten(path, chunk.chunk_start_offset + chunk.chunk_length + 15, 8)
    assert main([str(bag)]) == 2
    assert "broken index" in capsys.readouterr().err
    assert main([str(bag), "--repair"]) == 0
    assert ", 0 chunks lost\n" in capsys.readouterr().out
    assert _messages(bag) == expected


def test_repairing_writes_a_missing_metadata_file_as_it_was(bag: Path) -> None:
    before = (bag / "metadata.yaml").read_text()
    (bag / "metadata.yaml").unlink()
    assert main([str(bag), "--repair"]) == 0
    assert (bag / "metadata.yaml").read_text() == before


def test_a_file_with_a_picture_alone_can_be_looked_at(tmp_path, image_bytes, capsys) -> None:
    # The last pictures of an episode may come after all else, at the end of a run.
    with BagWriter(tmp_path / "bag", {"ground_truth": VECTOR, "features": IMAGE}, {}) as writer:
        writer.write("features", image_bytes(np.zeros((2, 2), np.float32), 0), 0)
    assert main([str(tmp_path / "bag" / "bag_0.mcap")]) == 0
    lines = _words(capsys.readouterr().out)
    assert lines["/features"][2] == "1"
    assert lines["/ground_truth"][2] == "0"


def test_changes_of_the_plant_and_diagnostics_show_no_gaps(tmp_path, vector_bytes, capsys) -> None:
    diagnostics = {"/diagnostics": "diagnostic_msgs/msg/DiagnosticArray"}
    topics = {"muscle_states": VECTOR, "parameter_changes": VECTOR} | diagnostics
    with BagWriter(tmp_path / "bag", topics, {}) as writer:
        for observation in range(90):
            stamp_ns = observation * PERIOD_NS
            message = vector_bytes(["x"], [1.0], stamp_ns)
            writer.write("muscle_states", message, stamp_ns)
            if observation in (20, 70):
                writer.write("parameter_changes", message, stamp_ns)
                writer.write("/diagnostics", b"\0\1\0\0" + bytes(16), stamp_ns)
    assert main([str(tmp_path / "bag")]) == 0
    lines = _words(capsys.readouterr().out)
    assert lines["/parameter_changes"][2:] == ["2", "-", "-", "-"]
    assert lines["/diagnostics"][2:] == ["2", "-", "-", "-"]
    assert lines["/muscle_states"][2:] == ["90", "10", "0", "-"]


def test_a_reader_that_has_seen_enough_is_no_error(bag: Path) -> None:
    # The reader is gone before the first line is written, which "head" is at some moment, too.
    done = subprocess.run(
        ["bash", "-o", "pipefail", "-c", f"{sys.executable} -m {main.__module__} {bag} | true"],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(p for p in sys.path if p)},
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert (done.returncode, done.stderr) == (0, "")
