"""BagWriter: what it writes is a rosbag2 bag that other libraries read, message by message."""

from pathlib import Path
from typing import Any

import pytest
import yaml
from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader
from rosbags.interfaces import QosDurability, QosHistory, QosReliability

from experiment_manager.bag.mcap_file import McapFile
from experiment_manager.bag.writer import BagWriter
from lockstep import InputError
from tests.experiment_manager.bag.bag_harness import (
    METADATA,
    N_MESSAGES,
    NAMES,
    PERIOD_NS,
    TOPICS,
    write_bag,
)


def test_rosbags_reads_back_every_message(tmp_path, messages) -> None:
    write_bag(tmp_path / "bag", messages)
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


def test_mcap_ros2_support_decodes_every_message(tmp_path, messages) -> None:
    write_bag(tmp_path / "bag", messages, n_per_file=1000)
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


def test_each_file_is_indexed_and_carries_the_run(tmp_path, messages) -> None:
    write_bag(tmp_path / "bag", messages, n_per_file=11)
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


def test_metadata_is_what_rosbag2_writes(tmp_path, messages) -> None:
    write_bag(tmp_path / "bag", messages, n_per_file=11)
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


def test_the_first_message_of_a_stamp_is_kept(tmp_path, vector_bytes) -> None:
    first, second = (vector_bytes(NAMES, [value, 0.0]) for value in (1.0, 2.0))
    with BagWriter(tmp_path / "bag", TOPICS, METADATA) as writer:
        assert writer.write("ground_truth", first, 5)
        assert not writer.write("ground_truth", second, 5)
        assert not writer.write("ground_truth", second, 4)
        assert writer.write("ground_truth", second, 6)
        writer.commit()
        assert not writer.write("ground_truth", first, 6), "a commit must not forget the stamps"
    with AnyReader([tmp_path / "bag"]) as reader:
        assert [(t, raw) for _, t, raw in reader.messages()] == [(5, first), (6, second)]


def test_clock_and_diagnostics_may_repeat_their_stamps(tmp_path, messages) -> None:
    with BagWriter(tmp_path / "bag", TOPICS, METADATA) as writer:
        writer.write("ground_truth", messages[0][1], 5)
        for stamp_ns in (7, 7, 3):
            assert writer.write("/clock", b"\0\1\0\0" + bytes(8), stamp_ns)
            assert writer.write("/diagnostics", b"\0\1\0\0" + bytes(16), stamp_ns)
    summary = McapFile(tmp_path / "bag" / "bag_0.mcap").summary()
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


def test_overwriting_is_refused(tmp_path: Path, messages: list[tuple[str, bytes, int]]) -> None:
    write_bag(tmp_path / "bag", messages)
    before = {p.name: p.read_bytes() for p in (tmp_path / "bag").iterdir()}
    with pytest.raises(InputError, match="expected a new or empty directory for the bag"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA)
    assert {p.name: p.read_bytes() for p in (tmp_path / "bag").iterdir()} == before
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match="is not empty"):
        BagWriter(tmp_path / "file", TOPICS, METADATA)
