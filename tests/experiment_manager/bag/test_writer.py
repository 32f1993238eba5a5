"""BagWriter: what it writes is a rosbag2 bag that other libraries read, message by message."""

import resource
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from mcap.reader import make_reader
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosHistory, QosReliability

from experiment_manager.bag.mcap_file import McapFile
from experiment_manager.bag.metadata import OfferedQos
from experiment_manager.bag.writer import BagWriter
from lockstep.errors import InputError
from lockstep.wire.qos import LOCKSTEP_QOS

TOPICS = {
    "ground_truth": "sensor_msgs/msg/JointState",
    "left/image_raw": "sensor_msgs/msg/Image",
    "/clock": "rosgraph_msgs/msg/Clock",
    "/diagnostics": "diagnostic_msgs/msg/DiagnosticArray",
}
METADATA = {"run_id": "run_7", "model": "M_C", "seed": "3"}
NAMES = ["vergence_deg", "metabolic_rate_w"]
PERIOD_NS = 100_000_000
N_MESSAGES = 30


@pytest.fixture
def messages(
    vector_bytes: Callable[..., bytes], image_bytes: Callable[..., bytes]
) -> list[tuple[str, bytes, int]]:
    """Thirty vectors, a picture with every tenth of them."""
    rng = np.random.default_rng(5)
    found = []
    for i in range(N_MESSAGES):
        stamp_ns = i * PERIOD_NS
        vector = vector_bytes(NAMES, [i, i + 0.5], stamp_ns)
        found.append(("ground_truth", vector, stamp_ns))
        if i % 10 == 0:
            picture = rng.integers(0, 256, (12, 16), dtype=np.uint8)
            found.append(("left/image_raw", image_bytes(picture, stamp_ns), stamp_ns))
    return found


def _write(directory: Path, messages: list[tuple[str, bytes, int]], n_per_file: int = 9) -> None:
    with BagWriter(directory, TOPICS, METADATA, configuration="run: {model: M_C}\n") as writer:
        for i, message in enumerate(messages):
            writer.write(*message)
            if (i + 1) % n_per_file == 0:
                writer.commit()


def test_rosbags_reads_back_every_message(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    _write(tmp_path / "bag", messages)
    with AnyReader([tmp_path / "bag"]) as reader:
        found = [(c.topic, c.msgtype, raw, t) for c, t, raw in reader.messages()]
        decoded: list[Any] = [
            reader.deserialize(raw, c.msgtype)
            for c, _, raw in reader.messages()
            if c.topic == "/ground_truth"
        ]
        extra: Any = reader.connections[0].ext
        (qos,) = extra.offered_qos_profiles
        hashes = {c.topic: c.digest for c in reader.connections}
    expected = [("/" + topic, TOPICS[topic], raw, t) for topic, raw, t in messages]
    assert sorted(found) == sorted(expected)
    assert [m.position[1] for m in decoded] == [i + 0.5 for i in range(N_MESSAGES)]
    assert [m.header.stamp.nanosec for m in decoded[:3]] == [0, PERIOD_NS, 2 * PERIOD_NS]
    assert (qos.history, qos.depth) == (QosHistory.KEEP_LAST, 64)
    assert (qos.reliability, qos.durability) == (QosReliability.RELIABLE, QosDurability.VOLATILE)
    # rosbags computes the hashes itself, from the schemas in the files.
    assert all(digest.startswith("RIHS01_") for digest in hashes.values())


def test_the_type_hashes_are_those_of_the_schemas(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    _write(tmp_path / "bag", messages)
    information = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    topics = information["rosbag2_bagfile_information"]["topics_with_message_count"]
    written = {
        t["topic_metadata"]["name"]: t["topic_metadata"]["type_description_hash"] for t in topics
    }
    with AnyReader([tmp_path / "bag"]) as reader:
        computed = {c.topic: reader.typestore.hash_rihs01(c.msgtype) for c in reader.connections}
    assert written == computed


def test_mcap_ros2_support_decodes_every_message(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    _write(tmp_path / "bag", messages, n_per_file=1000)
    with (tmp_path / "bag" / "bag_0.mcap").open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True, decoder_factories=[DecoderFactory()])
        assert reader.get_header().profile == "ros2"
        decoded = [
            (m.log_time, m.publish_time, list(d.name), list(d.position))
            for _, c, m, d in reader.iter_decoded_messages("/ground_truth")
        ]
        pictures = [d.encoding for _, _, _, d in reader.iter_decoded_messages("/left/image_raw")]
    assert decoded == [
        (i * PERIOD_NS, i * PERIOD_NS, NAMES, [i, i + 0.5]) for i in range(N_MESSAGES)
    ]
    assert pictures == ["mono8"] * 3


def test_each_file_is_indexed_and_carries_the_run(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    _write(tmp_path / "bag", messages, n_per_file=11)
    for name, n_messages in (("bag_0.mcap", 11), ("bag_2.mcap", 11)):
        with (tmp_path / "bag" / name).open("rb") as stream:
            reader = make_reader(stream)
            summary = reader.get_summary()
            assert summary is not None
            assert summary.statistics is not None
            (metadata,) = reader.iter_metadata()
            (attachment,) = reader.iter_attachments()
        assert summary.statistics.message_count == n_messages
        assert {c.compression for c in summary.chunk_indexes} == {"zstd"}
        assert all(c.message_index_offsets for c in summary.chunk_indexes)
        assert {s.encoding for s in summary.schemas.values()} == {"ros2msg"}
        assert {c.message_encoding for c in summary.channels.values()} == {"cdr"}
        assert (metadata.name, metadata.metadata) == ("run", METADATA)
        assert (attachment.name, attachment.data) == ("config.yaml", b"run: {model: M_C}\n")


def test_metadata_is_what_rosbag2_writes(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    _write(tmp_path / "bag", messages, n_per_file=11)
    document = yaml.safe_load((tmp_path / "bag" / "metadata.yaml").read_text())
    information = document["rosbag2_bagfile_information"]
    assert information["version"] == 9
    assert information["storage_identifier"] == "mcap"
    assert information["ros_distro"] == "jazzy"
    assert information["relative_file_paths"] == ["bag_0.mcap", "bag_1.mcap", "bag_2.mcap"]
    assert information["message_count"] == N_MESSAGES + 3
    assert information["starting_time"] == {"nanoseconds_since_epoch": 0}
    assert information["duration"] == {"nanoseconds": (N_MESSAGES - 1) * PERIOD_NS}
    assert information["custom_data"] == METADATA
    # The first 11 messages: 10 vectors with stamps 0 to 0.9 s ... and one picture.
    assert information["files"][0] == {
        "path": "bag_0.mcap",
        "starting_time": {"nanoseconds_since_epoch": 0},
        "duration": {"nanoseconds": 9 * PERIOD_NS},
        "message_count": 11,
    }
    counts = {
        t["topic_metadata"]["name"]: t["message_count"]
        for t in information["topics_with_message_count"]
    }
    assert counts == {
        "/ground_truth": N_MESSAGES,
        "/left/image_raw": 3,
        "/clock": 0,
        "/diagnostics": 0,
    }


def test_the_default_qos_is_that_of_the_graph() -> None:
    qos = OfferedQos()
    assert (qos.history, qos.depth, qos.reliability, qos.durability) == (
        LOCKSTEP_QOS.history.name.lower(),
        LOCKSTEP_QOS.depth,
        LOCKSTEP_QOS.reliability.name.lower(),
        LOCKSTEP_QOS.durability.name.lower(),
    )


def test_a_namespace_is_put_before_relative_names_only(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    with BagWriter(tmp_path / "bag", TOPICS, METADATA, namespace="/robot_1") as writer:
        writer.write(*messages[0])
    file = McapFile.open(tmp_path / "bag" / "bag_0.mcap")
    assert {c.topic for c in file.channels.values()} == {
        "/robot_1/ground_truth",
        "/robot_1/left/image_raw",
        "/clock",
        "/diagnostics",
    }


def test_the_first_message_of_a_stamp_is_kept(
    tmp_path: Path, vector_bytes: Callable[..., bytes]
) -> None:
    first, second = (vector_bytes(NAMES, [value, 0.0]) for value in (1.0, 2.0))
    with BagWriter(tmp_path / "bag", TOPICS, METADATA) as writer:
        assert writer.write("ground_truth", first, 5)
        assert not writer.write("ground_truth", second, 5)
        assert not writer.write("ground_truth", second, 4)
        assert writer.write("ground_truth", second, 6)
        assert writer.n_ignored["ground_truth"] == 2
        writer.commit()
        assert not writer.write("ground_truth", first, 6), "a commit must not forget the stamps"
    with AnyReader([tmp_path / "bag"]) as reader:
        assert [(t, raw) for _, t, raw in reader.messages()] == [(5, first), (6, second)]


def test_clock_and_diagnostics_may_repeat_their_stamps(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    with BagWriter(tmp_path / "bag", TOPICS, METADATA) as writer:
        writer.write("ground_truth", messages[0][1], 5)
        for stamp_ns in (7, 7, 3):
            assert writer.write("/clock", b"\0\1\0\0" + bytes(8), stamp_ns)
            assert writer.write("/diagnostics", b"\0\1\0\0" + bytes(16), stamp_ns)
    summary = McapFile.open(tmp_path / "bag" / "bag_0.mcap").summary()
    assert summary.message_counts["/clock"] == 3
    assert (summary.start_ns, summary.end_ns) == (3, 7)


def test_an_announced_topic_is_expected(tmp_path: Path) -> None:
    with BagWriter(tmp_path / "bag", TOPICS, METADATA) as writer:
        with pytest.raises(InputError, match=r"expected one of ground_truth, .* got topic"):
            writer.write("reward", b"", 0)
        with pytest.raises(InputError, match=r"expected a stamp in \[0, 2\^63\) ns, got -1"):
            writer.write("ground_truth", b"", -1)
        assert writer.files == []


@pytest.mark.parametrize(
    ("type_name", "error"),
    [
        ("JointState", "expected a type such as sensor_msgs/msg/Image, got 'JointState'"),
        ("sensor_msgs/msg/Nose", "expected an installed message type, got sensor_msgs/msg/Nose"),
    ],
)
def test_an_unknown_type_is_refused(tmp_path: Path, type_name: str, error: str) -> None:
    with pytest.raises(InputError, match=error):
        BagWriter(tmp_path / "bag", {"a": type_name}, {})
    assert not (tmp_path / "bag").exists()


def test_qos_of_an_unknown_topic_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="expected QoS of announced topics, got b"):
        BagWriter(tmp_path / "bag", {"a": "std_msgs/msg/Header"}, {}, qos={"b": OfferedQos()})


def test_overwriting_is_refused(tmp_path: Path, messages: list[tuple[str, bytes, int]]) -> None:
    _write(tmp_path / "bag", messages)
    before = {p.name: p.read_bytes() for p in (tmp_path / "bag").iterdir()}
    with pytest.raises(InputError, match="expected a new or empty directory for the bag"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA)
    assert {p.name: p.read_bytes() for p in (tmp_path / "bag").iterdir()} == before
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="already holds something"):
        BagWriter(tmp_path / "file", TOPICS, METADATA)


def test_resuming_deletes_what_was_not_committed_and_goes_on(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    directory = tmp_path / "bag"
    whole = tmp_path / "whole"
    _write(whole, messages, n_per_file=11)
    with BagWriter(directory, TOPICS, METADATA) as writer:
        for message in messages[:22]:
            writer.write(*message)
            if len(writer.files) == 0 and message is messages[10]:
                writer.commit()
    (directory / "notes.txt").write_text("the user's own")
    kept = (directory / "bag_0.mcap").read_bytes()

    with BagWriter(directory, TOPICS, METADATA, resume_files=["bag_0.mcap"]) as writer:
        assert sorted(p.name for p in directory.iterdir()) == [
            "bag_0.mcap",
            "metadata.yaml",
            "notes.txt",
        ]
        # The messages of the kept file come again and are known.
        assert [writer.write(*m) for m in messages] == [False] * 11 + [True] * (N_MESSAGES - 8)
        assert writer.n_ignored["ground_truth"] == 10

    assert (directory / "bag_0.mcap").read_bytes() == kept
    assert writer.files == ["bag_0.mcap", "bag_1.mcap"]
    with AnyReader([directory]) as resumed, AnyReader([whole]) as expected:
        assert [(c.topic, t, raw) for c, t, raw in resumed.messages()] == [
            (c.topic, t, raw) for c, t, raw in expected.messages()
        ]


def test_resuming_from_nothing_starts_anew(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    with BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=[]) as writer:
        writer.write(*messages[0])
    assert writer.files == ["bag_0.mcap"]


def test_resuming_needs_whole_files(tmp_path: Path, messages: list[tuple[str, bytes, int]]) -> None:
    _write(tmp_path / "bag", messages, n_per_file=11)
    first = tmp_path / "bag" / "bag_0.mcap"
    first.write_bytes(first.read_bytes()[:-1])
    names = ["bag_0.mcap", "bag_1.mcap"]
    with pytest.raises(InputError, match=r"bag_0\.mcap: expected a whole file, it is cut off"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=names)
    with pytest.raises(InputError, match=r"expected an \.mcap file, .*bag_9\.mcap is none"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=["bag_9.mcap"])
    with pytest.raises(InputError, match=r"expected a bag file such as bag_0\.mcap, got '\.\./x'"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=["../x"])
    assert (tmp_path / "bag" / "bag_2.mcap").exists(), "nothing may be deleted before all is well"


def test_what_was_written_can_be_read_before_the_end(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    with BagWriter(tmp_path / "bag", TOPICS, METADATA, flush_period_s=0.0) as writer:
        for message in messages:
            writer.write(*message)
        file = McapFile.open(tmp_path / "bag" / "bag_0.mcap")
        assert not file.complete
        assert file.summary().n_messages == len(messages)


def test_an_idle_writer_flushes_when_asked(
    tmp_path: Path, messages: list[tuple[str, bytes, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = [100.0]
    monkeypatch.setattr("experiment_manager.bag.writer.time.monotonic", lambda: now_s[0])
    with BagWriter(tmp_path / "bag", TOPICS, METADATA, flush_period_s=2.0) as writer:
        writer.flush_when_due()
        writer.write(*messages[0])
        now_s[0] += 1.9
        writer.flush_when_due()
        path = tmp_path / "bag" / "bag_0.mcap"
        assert not path.exists(), "an older message may still come"
        now_s[0] += 0.1
        writer.flush_when_due()
        assert McapFile.open(path).summary().n_messages == 1


# --- order


def _as_mcap_doctor_reads(path: Path) -> list[tuple[str, int]]:
    """Return (topic, log time) of all messages as they lie in a file, chunk by chunk.

    Asserts what `mcap doctor` warns of: each log time is no less than all before it.
    """
    found: list[tuple[str, int]] = []
    topics: dict[int, str] = {}
    with path.open("rb") as stream:
        for record in StreamReader(stream, validate_crcs=True).records:
            if isinstance(record, Channel):
                topics[record.id] = record.topic
            elif isinstance(record, Message):
                found.append((topics[record.channel_id], record.log_time))
    log_times_ns = [log_time_ns for _, log_time_ns in found]
    assert log_times_ns == sorted(log_times_ns), path.name
    return found


def test_messages_lie_in_the_order_of_their_stamps_and_topics(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    # Topic after topic, as bunches arrive; the diagnostics with the stamp of then.
    arrival = sorted(messages, key=lambda message: (message[0] == "ground_truth", message[2]))
    arrival.insert(2, ("/diagnostics", b"\0\1\0\0" + bytes(16), 3 * PERIOD_NS))
    with BagWriter(tmp_path / "bag", TOPICS, METADATA) as writer:
        assert all(writer.write(*message) for message in arrival)
        writer.release(15 * PERIOD_NS)
    names = {name: name if name.startswith("/") else f"/{name}" for name in TOPICS}
    assert _as_mcap_doctor_reads(tmp_path / "bag" / "bag_0.mcap") == [
        (names[topic], stamp_ns)
        for stamp_ns in range(0, N_MESSAGES * PERIOD_NS, PERIOD_NS)
        for topic in TOPICS
        if any((topic, stamp_ns) == (m[0], m[2]) for m in arrival)
    ]


def test_the_files_of_a_run_are_in_order_and_none_is_without_an_observation(
    small_run: Path,
) -> None:
    paths = sorted((small_run / "bag").glob("*.mcap"))
    assert paths
    for path in paths:
        assert "/ground_truth" in {topic for topic, _ in _as_mcap_doctor_reads(path)}


def test_what_is_released_is_written_and_the_rest_waits(
    tmp_path: Path, messages: list[tuple[str, bytes, int]], monkeypatch: pytest.MonkeyPatch
) -> None:
    now_s = [100.0]
    monkeypatch.setattr("experiment_manager.bag.writer.time.monotonic", lambda: now_s[0])
    vectors = [message for message in messages if message[0] == "ground_truth"]
    picture = next(message for message in messages if message[2] == 10 * PERIOD_NS)
    path = tmp_path / "bag" / "bag_0.mcap"
    with BagWriter(tmp_path / "bag", TOPICS, METADATA, flush_period_s=2.0) as writer:
        for vector in vectors[:20]:
            writer.write(*vector)
        writer.release(10 * PERIOD_NS)
        # What comes late is put in its place as long as it has not been released.
        writer.write("left/image_raw", picture[1], 10 * PERIOD_NS)
        # Of the others, those that arrived a flush period ago are handed over, too.
        now_s[0] += 1.5
        writer.write(*vectors[20])
        now_s[0] += 0.5
        writer.flush_when_due()
        assert McapFile.open(path).summary().n_messages == 21, "all but the youngest"
        now_s[0] += 2.0
        writer.flush_when_due()
        assert McapFile.open(path).summary().n_messages == 22
    assert len(_as_mcap_doctor_reads(path)) == 22


def test_a_file_begins_with_an_observation(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    diagnostics = b"\0\1\0\0" + bytes(16)
    directory = tmp_path / "bag"
    with BagWriter(directory, TOPICS, METADATA, flush_period_s=0.0) as writer:
        for _ in range(1500):
            writer.write("/diagnostics", diagnostics, 0)
        writer.commit()
        assert writer.files == [], "nothing but diagnostics"
        writer.write(*messages[0])
        writer.commit()
        writer.write("/diagnostics", diagnostics, 7)
        writer.flush_when_due()
        assert [path.name for path in directory.glob("*.mcap")] == ["bag_0.mcap"]
    assert writer.files == ["bag_0.mcap"]
    counts = McapFile.open(directory / "bag_0.mcap").summary().message_counts
    assert (counts["/ground_truth"], counts["/diagnostics"]) == (1, 1000)


@contextmanager
def small_files_only() -> Iterator[None]:
    """Let the system refuse to make any file longer than 4 kB, as a full disk would."""
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (4096, limits[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
        signal.signal(signal.SIGXFSZ, handler)


def test_a_refused_write_is_raised_and_ends_the_writer(
    tmp_path: Path, messages: list[tuple[str, bytes, int]]
) -> None:
    writer = BagWriter(tmp_path / "bag", TOPICS, METADATA)
    writer.write(*messages[0])
    with small_files_only(), pytest.raises(OSError, match="File too large"):
        writer.commit()
    with pytest.raises(OSError, match="an earlier write failed"):
        writer.write(*messages[1])
    writer.close()
    assert writer.files == []
    assert not (tmp_path / "bag" / "metadata.yaml").exists()
