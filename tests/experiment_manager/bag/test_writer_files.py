"""BagWriter: which message comes into which file, in which order, and when it can be read."""

import resource
import signal
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from mcap.records import Channel, Message
from mcap.stream_reader import StreamReader
from rosbags.highlevel import AnyReader

from experiment_manager.bag.mcap_file import McapFile
from experiment_manager.bag.writer import BagWriter
from lockstep import InputError
from tests.experiment_manager.bag.bag_harness import (
    METADATA,
    N_MESSAGES,
    PERIOD_NS,
    TOPICS,
    write_bag,
)


def test_resuming_deletes_what_was_not_committed_and_goes_on(tmp_path, messages) -> None:
    directory = tmp_path / "bag"
    whole = tmp_path / "whole"
    write_bag(whole, messages, n_per_file=11)
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

    assert (directory / "bag_0.mcap").read_bytes() == kept
    assert writer.files == ["bag_0.mcap", "bag_1.mcap"]
    with AnyReader([directory]) as resumed, AnyReader([whole]) as expected:
        assert [(c.topic, t, raw) for c, t, raw in resumed.messages()] == [
            (c.topic, t, raw) for c, t, raw in expected.messages()
        ]


def test_resuming_needs_whole_files(tmp_path: Path, messages: list[tuple[str, bytes, int]]) -> None:
    write_bag(tmp_path / "bag", messages, n_per_file=11)
    first = tmp_path / "bag" / "bag_0.mcap"
    first.write_bytes(first.read_bytes()[:-1])
    names = ["bag_0.mcap", "bag_1.mcap"]
    with pytest.raises(InputError, match=r"bag_0\.mcap: expected a complete file, it is cut off"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=names)
    with pytest.raises(InputError, match=r"expected an \.mcap file, .*bag_9\.mcap is none"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=["bag_9.mcap"])
    with pytest.raises(InputError, match=r"expected a bag file such as bag_0\.mcap, got '\.\./x'"):
        BagWriter(tmp_path / "bag", TOPICS, METADATA, resume_files=["../x"])
    assert (tmp_path / "bag" / "bag_2.mcap").exists(), "nothing may be deleted before all is well"


def test_an_idle_writer_flushes_when_asked(tmp_path, messages, monkeypatch) -> None:
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
        assert McapFile(path).summary().n_messages == 1


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


def test_messages_lie_in_the_order_of_their_stamps_and_topics(tmp_path, messages) -> None:
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


def test_the_files_of_a_run_are_in_order_and_none_is_without_an_observation(small_run) -> None:
    paths = sorted((small_run / "bag").glob("*.mcap"))
    assert paths
    for path in paths:
        assert "/ground_truth" in {topic for topic, _ in _as_mcap_doctor_reads(path)}


def test_what_is_released_is_written_and_the_rest_waits(tmp_path, messages, monkeypatch) -> None:
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
        assert McapFile(path).summary().n_messages == 21, "all but the youngest"
        now_s[0] += 2.0
        writer.flush_when_due()
        assert McapFile(path).summary().n_messages == 22
    assert len(_as_mcap_doctor_reads(path)) == 22


def test_a_file_begins_with_an_observation(tmp_path, messages) -> None:
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
    counts = McapFile(directory / "bag_0.mcap").summary().message_counts
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


def test_a_refused_write_is_raised_and_ends_the_writer(tmp_path, messages) -> None:
    writer = BagWriter(tmp_path / "bag", TOPICS, METADATA)
    writer.write(*messages[0])
    with small_files_only(), pytest.raises(OSError, match="File too large"):
        writer.commit()
    with pytest.raises(OSError, match="an earlier write failed"):
        writer.write(*messages[1])
    writer.close()
    assert writer.files == []
    assert not (tmp_path / "bag" / "metadata.yaml").exists()
