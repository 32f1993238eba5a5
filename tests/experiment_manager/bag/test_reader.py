"""The bag reader: columns and pictures as written, and as far as a cut-off file goes."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.records import ChunkIndex

from experiment_manager import Bag
from experiment_manager.bag.mcap_file import McapFile
from experiment_manager.bag.writer import BagWriter
from lockstep import InputError

VECTOR = "sensor_msgs/msg/JointState"
IMAGE = "sensor_msgs/msg/Image"
NAMES = ["vergence_deg", "metabolic_rate_w", "x"]


@pytest.fixture
def values() -> np.ndarray:
    return np.random.default_rng(3).normal(size=(500, 3))


def test_the_columns_are_what_was_written(make_bag, values) -> None:
    table = Bag(make_bag({"ground_truth": (NAMES, values)}, n_files=3)).vectors("ground_truth")[
        "ground_truth"
    ]
    assert table.names == tuple(NAMES)
    assert np.array_equal(table.position, values)
    assert np.array_equal(table.stamps_ns, np.arange(500) * 100_000_000)
    assert table.velocity.shape == table.effort.shape == (500, 0)
    assert np.array_equal(table.column("metabolic_rate_w"), values[:, 1])


def test_velocity_and_effort_are_read_with_every_alignment(tmp_path, vector_bytes) -> None:
    # The lengths of the names move the doubles through all offsets modulo 8.
    for i, names in enumerate((["a"], ["abcd", "b"], ["abcdefg", "hij"], ["abcdefgh", "ijklmnop"])):
        parts = np.arange(3.0 * len(names)).reshape(3, len(names))
        present = {"velocity": parts[1], "effort": parts[2]}
        for j, fields in enumerate(((), ("velocity",), ("effort",), ("velocity", "effort"))):
            directory = tmp_path / f"{i}{j}"
            with BagWriter(directory, {"a": VECTOR}, {}) as writer:
                chosen = {field: present[field] for field in fields}
                writer.write("a", vector_bytes(names, parts[0], **chosen), 0)
            table = Bag(directory).vectors("a")["a"]
            expected = {f: present[f] if f in fields else [] for f in present}
            assert np.array_equal(table.position, parts[:1])
            assert table.velocity.tolist() == [list(expected["velocity"])]
            assert table.effort.tolist() == [list(expected["effort"])]


def test_what_the_padding_holds_does_not_matter(tmp_path, vector_bytes) -> None:
    messages = [bytearray(vector_bytes(["a", "b"], [i, -i])) for i in range(4)]
    # Header 4, stamp 8, frame: length 4 and "\0", then 3 bytes of padding.
    assert messages[1][17:20] == b"\0\0\0"
    for message in messages:
        message[17:20] = b"\x05\xd0\x7f"
    messages[2][17:20] = b"\0\0\0"
    with BagWriter(tmp_path / "bag", {"a": VECTOR}, {}) as writer:
        for i, message in enumerate(messages):
            writer.write("a", bytes(message), i)
    assert Bag(tmp_path / "bag").vectors("a")["a"].position.tolist() == [
        [0, 0],
        [1, -1],
        [2, -2],
        [3, -3],
    ]


def test_changing_names_make_columns_with_gaps(tmp_path, vector_bytes) -> None:
    with BagWriter(tmp_path / "bag", {"muscle_command": VECTOR}, {}) as writer:
        for i, names in enumerate((["aa", "bb"], ["aa", "cc"], ["d"], ["bb", "aa"])):
            writer.write("muscle_command", vector_bytes(names, [i + 1.0, -i][: len(names)]), i)
    table = Bag(tmp_path / "bag").vectors("muscle_command")["muscle_command"]
    nan = np.nan
    assert table.names == ("aa", "bb", "cc", "d")
    expected = [[1, 0, nan, nan], [2, nan, -1, nan], [nan, nan, nan, 3], [-3, 4, nan, nan]]
    assert np.array_equal(table.position, expected, equal_nan=True)


def test_rows_are_found_by_stamp(make_bag: Callable[..., Path], values: np.ndarray) -> None:
    table = Bag(make_bag({"a": (NAMES, values[:4])})).vectors("a")["a"]
    stamps_ns = np.array([300_000_000, 5, 0, 400_000_000])
    assert table.at(stamps_ns).tolist() == [3, -1, 0, -1]


def test_topics_are_found_by_their_last_parts(tmp_path, image_bytes) -> None:
    topics = {"/a/left/image_raw": IMAGE, "/b/left/image_raw": IMAGE, "/b/reward": VECTOR}
    with BagWriter(tmp_path / "bag", topics | {"/clock": "rosgraph_msgs/msg/Clock"}, {}) as writer:
        writer.write("/a/left/image_raw", image_bytes(np.zeros((2, 2), np.uint8), 0), 0)
    bag = Bag(tmp_path / "bag")
    assert bag.topic("reward") == "/b/reward"
    assert bag.topic("b/left/image_raw") == "/b/left/image_raw"
    assert bag.types["/clock"] == "rosgraph_msgs/msg/Clock"
    with pytest.raises(InputError, match="expected one topic 'left/image_raw', found /a/left"):
        bag.topic("left/image_raw")
    with pytest.raises(InputError, match="expected one topic 'ward', found none among"):
        bag.topic("ward")
    assert len(bag.vectors("reward")["reward"].stamps_ns) == 0


def test_pictures_are_read_by_stamp(tmp_path: Path, image_bytes: Callable[..., bytes]) -> None:
    rng = np.random.default_rng(1)
    pictures = [rng.integers(0, 256, (5, 7), dtype=np.uint8) for _ in range(4)]
    features = rng.normal(size=(2, 6)).astype(np.float32)
    with BagWriter(tmp_path / "bag", {"left/image_raw": IMAGE, "features": IMAGE}, {}) as writer:
        for i, picture in enumerate(pictures):
            writer.write("left/image_raw", image_bytes(picture, i), i)
        writer.write("features", image_bytes(features, 9), 9)
    bag = Bag(tmp_path / "bag")
    assert bag.stamps_ns("left/image_raw").tolist() == [0, 1, 2, 3]
    chosen = list(bag.images("left/image_raw", [3, 1, 77]))
    assert [stamp for stamp, _ in chosen] == [1, 3]
    assert all(np.array_equal(array, pictures[stamp]) for stamp, array in chosen)
    ((stamp, array),) = bag.images("features")
    assert stamp == 9
    assert array.dtype == np.float32
    assert np.array_equal(array, features)


def test_what_is_no_vector_or_picture_is_refused(tmp_path, vector_bytes) -> None:
    topics = {"a": VECTOR, "b": IMAGE, "c": VECTOR, "d": VECTOR, "e": VECTOR}
    with BagWriter(tmp_path / "bag", topics, {}) as writer:
        writer.write("a", b"\0\1\0\0" + bytes(5), 0)
        writer.write("b", b"\0\1\0\0" + bytes(40), 0)
        writer.write("c", b"\0\7\0\0" + bytes(40), 0)
        writer.write("d", vector_bytes(["a", "b"], [1.0]), 0)
        writer.write("e", vector_bytes(["a"], [1.0])[:-24], 0)
    bag = Bag(tmp_path / "bag")
    for topic, error in (
        ("a", "expected a serialized JointState"),
        ("b", "expected sensor_msgs/msg/JointState, got sensor_msgs/msg/Image"),
        ("c", "expected a serialized JointState"),
        ("d", "expected a number for each of 2 names, got 1"),
        ("e", "expected a "),
    ):
        with pytest.raises(InputError, match=error):
            bag.vectors(topic)
    with pytest.raises(InputError, match="expected a little-endian mono8 or 32FC1 image"):
        list(bag.images("b"))


def test_a_bag_is_expected(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"expected a bag directory or an \.mcap file"):
        Bag(tmp_path / "none")
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"expected \.mcap files in the bag directory"):
        Bag(tmp_path / "empty")
    (tmp_path / "empty" / "metadata.yaml").write_text("rosbag2_bagfile_information: 5\n")
    with pytest.raises(InputError, match="expected what rosbag2 writes"):
        Bag(tmp_path / "empty")
    (tmp_path / "foreign.mcap").write_bytes(b"PK\3\4 something else")
    with pytest.raises(InputError, match="expected an MCAP file, its first bytes are others"):
        Bag(tmp_path / "foreign.mcap")


def test_a_listed_file_that_is_gone_is_named(make_bag, values) -> None:
    directory = make_bag({"a": (NAMES, values)}, n_files=3)
    (directory / "bag_1.mcap").unlink()
    with pytest.raises(InputError, match=r"metadata\.yaml lists bag_1\.mcap, not there"):
        Bag(directory)


def test_files_are_read_in_their_order_without_metadata(make_bag, values) -> None:
    directory = make_bag({"a": (NAMES, values[:24])}, n_files=12)
    (directory / "metadata.yaml").unlink()
    assert len(list(directory.glob("bag_*.mcap"))) == 12
    assert np.array_equal(Bag(directory).vectors("a")["a"].position, values[:24])


def _end(chunk: ChunkIndex) -> int:
    return chunk.chunk_start_offset + chunk.chunk_length


@pytest.fixture
def chunked(tmp_path, vector_bytes, monkeypatch) -> tuple[Path, np.ndarray]:
    """A file with some twenty chunks of vectors; and the vectors."""
    monkeypatch.setattr("experiment_manager.bag.writer._CHUNK_BYTES", 3000)
    values = np.random.default_rng(8).normal(size=(400, 3))
    with BagWriter(tmp_path / "bag", {"a": VECTOR, "b": VECTOR}, {"seed": "4"}) as writer:
        for i, row in enumerate(values):
            writer.write("a", vector_bytes(NAMES, row), i)
            writer.write("b", vector_bytes(["n"], [i]), i)
    return tmp_path / "bag" / "bag_0.mcap", values


@pytest.mark.parametrize("garbage", [b"", bytes(40), bytes(range(3, 250)) * 20])
def test_a_file_cut_at_any_byte_opens_up_to_the_last_complete_chunk(
    chunked: tuple[Path, np.ndarray], tmp_path: Path, garbage: bytes
) -> None:
    path, values = chunked
    whole, content, cut_off = McapFile(path), path.read_bytes(), tmp_path / "cut.mcap"
    ends = [_end(chunk) for chunk in whole.chunks("/a")]
    assert len(ends) > 15
    counts = [0, *np.cumsum([len(whole.index(chunk, "/a")) for chunk in whole.chunks("/a")])]
    anywhere = np.random.default_rng(21).integers(8, len(content), 30).tolist()
    for cut in (*anywhere, *ends[:3], *(end - 1 for end in ends[:3])):
        cut_off.write_bytes(content[:cut] + garbage)
        bag = Bag(cut_off)
        assert not bag.files[0].complete
        n_chunks = int(np.searchsorted(ends, cut, side="right"))
        if n_chunks:
            assert np.array_equal(bag.vectors("a")["a"].position, values[: counts[n_chunks]])
            assert bag.metadata["run"] == {"seed": "4"}


def test_a_broken_chunk_is_named(chunked: tuple[Path, np.ndarray]) -> None:
    path, _ = chunked
    start = McapFile(path).chunks("/a")[2].chunk_start_offset
    content = bytearray(path.read_bytes())
    content[start + 500] ^= 0xFF
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"bag_0\.mcap: broken chunk at byte {start}"):
        Bag(path).vectors("a")


def test_damaged_bytes_are_one_clear_error_or_do_no_harm(chunked, tmp_path) -> None:
    path, values = chunked
    content = path.read_bytes()
    rng = np.random.default_rng(14)
    n_refused = 0
    for n_damaged in (1, 2, 30) * 20:
        damaged = bytearray(content)
        # The first eight bytes are another test's; half the damage goes to the index at the end.
        first = 8 if rng.random() < 0.5 else len(content) - 6000
        for place in rng.integers(first, len(content), n_damaged).tolist():
            damaged[place] = int(rng.integers(256))
        (tmp_path / "damaged.mcap").write_bytes(damaged)
        try:
            table = Bag(tmp_path / "damaged.mcap").vectors("a")["a"]
        except InputError:
            n_refused += 1
            continue
        assert len(table.position) <= len(values)
        assert np.isin(table.position, values).all(), "a wrong number passed for a recorded one"
    assert 0 < n_refused < 60
