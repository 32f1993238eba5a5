"""Writes a rosbag2 directory of .mcap files that survives a kill at any moment."""

import contextlib
import re
import time
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import BinaryIO

import yaml
from mcap.writer import Writer

from experiment_manager.bag.mcap_file import McapFile
from experiment_manager.bag.message_definitions import message_definition
from experiment_manager.bag.metadata import (
    CONFIGURATION_ATTACHMENT,
    METADATA_FILE,
    RUN_METADATA,
    FileSummary,
    Topic,
    bag_information,
    write_metadata,
)
from experiment_manager.bag.reordering import Held, StampBuffer
from lockstep import InputError
from lockstep.files.durable_files import is_free, sync, sync_directory

# Kept whatever their stamps.
_EXEMPT = frozenset(("/clock", "/diagnostics"))
_CHUNK_BYTES = 1 << 20
# Of the flush period, the longest that a message waits for older ones.
_HOLD_SHARE = 0.5
# While nothing else comes, no more exempt messages are held back than these.
_MOST_EXEMPT_HELD = 1000
_FILE_NAME = re.compile(r"^bag_(\d+)\.mcap$")


class BagWriter(contextlib.AbstractContextManager["BagWriter"]):
    """A rosbag2 directory under construction: metadata.yaml, bag_0.mcap, bag_1.mcap, ...

    Each commit ends a file; what was committed is never touched again. A file begins with the first
    message that is not exempt. In a file the messages lie in the order of their stamps, those of
    one stamp in the order of the topics: they are held back until `release` says that nothing older
    will come, or for half a flush period. Between commits complete chunks are handed to the system
    at least every flush period, so that a kill loses no more than one and a half of them, and a
    cut-off file still opens up to its last complete chunk.
    """

    def __init__(
        self,
        directory: Path,
        topics: Mapping[str, str],
        metadata: Mapping[str, str],
        *,
        configuration: str = "",
        resume_files: Sequence[str] | None = None,
        flush_period_s: float = 2.0,
    ) -> None:
        """Make the directory, or continue the one that holds resume_files.

        topics: {name: type such as sensor_msgs/msg/Image}; a relative name is recorded in the
        root namespace. metadata: the run in short, {key: text}, a metadata record of each file and
        custom_data of metadata.yaml. configuration: the text attached to each file as config.yaml;
        without it the metadata as YAML. resume_files: the committed files to keep; other
        bag_N.mcap are deleted.

        Raises InputError for a directory that is not empty, an unknown type, or a
        resume file that is missing or not whole.
        """
        self._directory = Path(directory)
        self._metadata = dict(metadata)
        self._configuration = configuration or yaml.safe_dump(self._metadata)
        self._topics = {name: _topic(name, type_name) for name, type_name in topics.items()}
        self._flush_period_s = flush_period_s
        self._last_stamp_ns = dict.fromkeys(topics, -1)
        self._buffer = StampBuffer(topics)
        self._flushed_s = time.monotonic()
        self._committed: list[FileSummary] = []
        self._open: _OpenFile | None = None
        self._failed = False
        if resume_files is not None:
            self._continue(resume_files)
            return
        if not is_free(self._directory):
            raise InputError(
                f"expected a new or empty directory for the bag, {self._directory} is not empty"
            )
        self._directory.mkdir(parents=True, exist_ok=True)

    def write(self, topic: str, message: bytes, stamp_ns: int) -> bool:
        """Record a serialized message (CDR) at its stamp; False when it was a repeat.

        A stamp that is not greater than the last one of its topic is a repeat and not written.
        Raises InputError for a topic that was not announced, OSError when the disk refuses; after
        that nothing more can be written.
        """
        last_ns = self._last_stamp_ns.get(topic)
        if last_ns is None:
            raise InputError(
                f"bag {self._directory}: expected one of {', '.join(self._last_stamp_ns)}, "
                f"got topic {topic!r}"
            )
        if not 0 <= stamp_ns < 1 << 63:
            raise InputError(f"bag topic {topic}: expected a stamp in [0, 2^63) ns, got {stamp_ns}")
        if stamp_ns <= last_ns and topic not in _EXEMPT:
            return False
        self._last_stamp_ns[topic] = max(stamp_ns, last_ns)
        with self._guarded():
            self._buffer.add(topic, message, stamp_ns, time.monotonic())
            self._flush_when_due()
        return True

    def describe(self, configuration: str) -> None:
        """Attach this text as config.yaml to the files that begin from now on."""
        self._configuration = configuration

    @property
    def n_bytes(self) -> int:
        """How many bytes the open file has, 0 without one."""
        return self._open.n_bytes if self._open is not None else 0

    def release(self, before_ns: int) -> None:
        """Write what has a smaller stamp: nothing older than that will come."""
        with self._guarded():
            self._put(self._buffer.take_before(before_ns))

    def flush_when_due(self) -> None:
        """Hand what was written to the system if the flush period is over; for an idle timer."""
        with self._guarded():
            self._flush_when_due()

    def commit(self) -> None:
        """End and sync the current file and replace metadata.yaml; the next write starts a file."""
        with self._guarded():
            self._put(self._buffer.take_all())
            if self._open is not None:
                self._committed.append(self._open.finish())
                self._open = None
                sync_directory(self._directory)
            information = bag_information([*self._topics.values()], self._committed, self._metadata)
            write_metadata(self._directory, information)

    def close(self) -> None:
        """Commit; after a failed write only let go of the file, which stays cut off."""
        if not self._failed:
            self.commit()
        elif self._open is not None:
            self._open.abandon()
            self._open = None

    @property
    def files(self) -> list[str]:
        """Names of the committed files, in order."""
        return [file.name for file in self._committed]

    def __exit__(self, *exception: object) -> None:
        """Close."""
        self.close()

    @contextlib.contextmanager
    def _guarded(self) -> Iterator[None]:
        """Mark the writer as failed when the body is left by an error.

        What came next would not fit the index of a file whose last record is half-written.
        """
        if self._failed:
            raise OSError(f"bag {self._directory}: an earlier write failed")
        try:
            yield
        except BaseException:
            self._failed = True
            raise

    def _flush_when_due(self) -> None:
        now_s = time.monotonic()
        if now_s - self._flushed_s < self._flush_period_s:
            return
        self._flushed_s = now_s
        self._put(self._buffer.take_arrived_by(now_s - _HOLD_SHARE * self._flush_period_s))
        if self._open is not None:
            self._open.flush()

    def _put(self, messages: list[Held]) -> None:
        """Write messages into the open file, or into a new one if an observation is among them."""
        if self._open is None:
            if all(held.topic in _EXEMPT for held in messages):
                self._buffer.put_back(messages[-_MOST_EXEMPT_HELD:])
                return
            self._open = self._next_file()
        for held in messages:
            self._open.write(held.topic, held.message, held.stamp_ns)

    def _next_file(self) -> "_OpenFile":
        numbers = [int(number) for name in self.files for number in _FILE_NAME.findall(name)]
        number = 1 + max(numbers, default=-1)
        return _OpenFile(
            self._directory / f"bag_{number}.mcap",
            self._topics,
            self._metadata,
            self._configuration,
        )

    def _continue(self, names: Sequence[str]) -> None:
        self._directory.mkdir(parents=True, exist_ok=True)
        for name in names:
            if not _FILE_NAME.match(name):
                raise InputError(f"expected a bag file such as bag_0.mcap, got {name!r}")
            file = McapFile(self._directory / name)
            if not file.complete:
                raise InputError(
                    f"{self._directory / name}: expected a complete file, it is cut off"
                )
            self._committed.append(file.summary())
            for topic, announced in self._topics.items():
                last_ns = file.last_stamp_ns(announced.name)
                self._last_stamp_ns[topic] = max(self._last_stamp_ns[topic], last_ns)
        for path in self._directory.iterdir():
            if _FILE_NAME.match(path.name) and path.name not in names:
                path.unlink()
        self.commit()


class _OpenFile:
    """The .mcap file that is being written."""

    def __init__(
        self,
        path: Path,
        topics: Mapping[str, Topic],
        metadata: Mapping[str, str],
        configuration: str,
    ) -> None:
        self._path = path
        self._stream: BinaryIO = path.open("xb")
        self._writer = Writer(self._stream, chunk_size=_CHUNK_BYTES)
        self._writer.start(profile="ros2")
        self._writer.add_metadata(RUN_METADATA, dict(metadata))
        self._writer.add_attachment(
            create_time=0,
            log_time=0,
            name=CONFIGURATION_ATTACHMENT,
            media_type="application/yaml",
            data=configuration.encode(),
        )
        self._channels = self._register(topics)
        self._counts = dict.fromkeys(topics, 0)

    @property
    def n_bytes(self) -> int:
        """How many bytes have been written so far."""
        return self._stream.tell()

    def _register(self, topics: Mapping[str, Topic]) -> dict[str, int]:
        schemas: dict[str, int] = {}
        channels: dict[str, int] = {}
        for name, topic in topics.items():
            if topic.type_name not in schemas:
                text = message_definition(topic.type_name).text
                schemas[topic.type_name] = self._writer.register_schema(
                    topic.type_name, "ros2msg", text.encode()
                )
            channels[name] = self._writer.register_channel(
                topic.name,
                "cdr",
                schemas[topic.type_name],
                {"offered_qos_profiles": topic.qos, "topic_type_hash": topic.type_hash},
            )
        return channels

    def write(self, topic: str, message: bytes, stamp_ns: int) -> None:
        self._writer.add_message(
            self._channels[topic], stamp_ns, message, stamp_ns, self._counts[topic]
        )
        self._counts[topic] += 1

    def flush(self) -> None:
        self._writer.flush()

    def finish(self) -> FileSummary:
        self._writer.finish()
        sync(self._stream)
        self._stream.close()
        return McapFile(self._path).summary()

    def abandon(self) -> None:
        # Closing writes the rest of the buffer, and may fail for the reason that was raised before.
        with contextlib.suppress(OSError):
            self._stream.close()


def remove_bag(directory: Path) -> None:
    """Remove the files of a bag, and the directory unless it holds anything else."""
    for path in directory.glob("*"):
        if _FILE_NAME.match(path.name) or path.name == METADATA_FILE:
            path.unlink()
    with contextlib.suppress(OSError):
        directory.rmdir()


def _topic(name: str, type_name: str) -> Topic:
    full_name = name if name.startswith("/") else f"/{name}"
    return Topic(full_name, type_name, message_definition(type_name).type_hash)
