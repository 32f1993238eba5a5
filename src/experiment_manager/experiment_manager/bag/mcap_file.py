"""One .mcap file, whole or cut off at any byte, read and rewritten with the package mcap."""

import struct
import zlib
from collections.abc import Iterator
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import BinaryIO, NamedTuple

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import FOOTER_SIZE, SeekingReader
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    ChunkIndex,
    Footer,
    McapRecord,
    Message,
    MessageIndex,
    Metadata,
    Schema,
)
from mcap.stream_reader import MAGIC_SIZE, StreamReader, breakup_chunk, get_chunk_data_stream
from mcap.summary import Summary
from mcap.writer import MCAP0_MAGIC, Writer

from experiment_manager.bag.metadata import FileSummary
from lockstep import InputError

# What a message record begins with, its data follow; the length counts from behind itself.
HEAD = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
HEAD_BYTES_IN_LENGTH = HEAD.itemsize - 9
_RECORD_HEAD_BYTES = 9  # opcode and length of any record
# What broken bytes make of the package's readers and of compressed blocks.
_BROKEN = (
    McapError,
    struct.error,
    ValueError,
    KeyError,
    OverflowError,
    MemoryError,
    RuntimeError,
    zstandard.ZstdError,
)


class Rewritten(NamedTuple):
    """What was kept and lost of a file: messages, and chunks that are broken or half-written."""

    n_messages: int
    n_lost_chunks: int


class McapFile:
    """One .mcap file: what its index holds, and its messages chunk by chunk.

    complete: it ends with its index. A file without one is read as its repair would leave it.
    topics: {topic: id of its channel}. metadata: {record name: {key: text}}. attachments: {name:
    content}.
    """

    def __init__(self, path: Path) -> None:
        """Read the index; InputError for what is no MCAP file, or a broken one with an index."""
        if not path.is_file():
            raise InputError(f"expected an .mcap file, {path} is none")
        self.path = path
        self._rewritten: bytes | None = None
        with path.open("rb") as stream:
            # A kill may leave less than the first eight bytes: a file cut off before anything.
            if not MCAP0_MAGIC.startswith(stream.read(MAGIC_SIZE)):
                raise InputError(f"{path}: expected an MCAP file, its first bytes are others")
            self.complete = _is_indexed(stream)
            if not self.complete:
                rewritten = BytesIO()
                rewrite(stream, rewritten)
                self._rewritten = rewritten.getvalue()
        try:
            with self._open() as stream:
                reader = SeekingReader(stream)
                self._summary = reader.get_summary() or Summary()
                self.metadata = {r.name: dict(r.metadata) for r in reader.iter_metadata()}
                self.attachments = {r.name: r.data for r in reader.iter_attachments()}
        except _BROKEN as error:
            raise InputError(f"{path}: broken metadata or attachment: {error}") from error
        self.topics = {channel.topic: i for i, channel in self.channels.items()}

    @property
    def channels(self) -> dict[int, Channel]:
        """The channels by id."""
        return self._summary.channels

    def type_name(self, channel_id: int) -> str:
        """Return the message type of a channel, such as sensor_msgs/msg/Image."""
        schema = self._summary.schemas.get(self.channels[channel_id].schema_id)
        return schema.name if schema else ""

    def chunks(self, *topics: str) -> list[ChunkIndex]:
        """Return the chunks, in the file's order, that hold messages of any of these topics."""
        wanted = {self.topics[topic] for topic in topics if topic in self.topics}
        return [
            chunk
            for chunk in self._summary.chunk_indexes
            if not wanted.isdisjoint(chunk.message_index_offsets)
        ]

    def read_chunk(self, chunk: ChunkIndex) -> np.ndarray:
        """Return the records of a chunk, decompressed: (n_bytes,) uint8.

        Raises InputError when the chunk does not fit its checksum.
        """
        try:
            with self._open() as stream:
                stream.seek(chunk.chunk_start_offset + _RECORD_HEAD_BYTES)
                record = Chunk.read(ReadDataStream(stream))
                data, n_bytes = get_chunk_data_stream(record, validate_crc=True)
                return np.frombuffer(data.read(n_bytes), np.uint8)
        except _BROKEN as error:
            raise InputError(
                f"{self.path}: broken chunk at byte {chunk.chunk_start_offset}: {error}"
            ) from error

    def index(self, chunk: ChunkIndex, topic: str) -> np.ndarray:
        """Return log time and offset in the chunk of each message of a topic: (n, 2) int64."""
        offset = chunk.message_index_offsets.get(self.topics.get(topic, -1))
        if offset is None:
            return np.zeros((0, 2), np.int64)
        try:
            with self._open() as stream:
                stream.seek(offset)
                record = next(StreamReader(stream, skip_magic=True).records)
            if not isinstance(record, MessageIndex):
                raise McapError(f"expected a message index, got {type(record).__name__}")
            return np.array(record.records, np.int64).reshape(-1, 2)
        except _BROKEN as error:
            raise InputError(f"{self.path}: broken index at byte {offset}: {error}") from error

    def heads(self, chunk: ChunkIndex, topic: str, data: np.ndarray) -> tuple[np.ndarray, ...]:
        """Return where the messages of a topic begin in a chunk's data, and their heads.

        data: of `read_chunk`. Offsets of the heads (n,) int64 and heads (n,) of HEAD. Raises
        InputError when the index does not fit the chunk.
        """
        log_times_ns, offsets = self.index(chunk, topic).T
        inside = (offsets >= 0) & (offsets <= len(data) - HEAD.itemsize)
        heads = rows_at(data, offsets * inside, HEAD.itemsize).view(HEAD)[:, 0]
        fits = inside & (heads["opcode"] == Opcode.MESSAGE) & (heads["log_time"] == log_times_ns)
        if not (fits & (heads["channel"] == self.topics.get(topic))).all():
            raise InputError(
                f"{self.path}: broken index of the chunk at byte {chunk.chunk_start_offset}"
            )
        return offsets, heads

    def stamps_ns(self, topic: str) -> np.ndarray:
        """Return the stamps of all messages of a topic (n,) int64, in the file's order."""
        times = [self.index(chunk, topic)[:, 0] for chunk in self.chunks(topic)]
        return np.concatenate([np.zeros(0, np.int64), *times])

    def last_stamp_ns(self, topic: str) -> int:
        """Return the greatest stamp of a topic, -1 where it has no message."""
        last = self.chunks(topic)[-1:]
        return max((int(self.index(chunk, topic)[:, 0].max()) for chunk in last), default=-1)

    def is_whole(self) -> bool:
        """Whether nothing is missing or broken."""
        try:
            for chunk in self._summary.chunk_indexes:
                data = self.read_chunk(chunk)
                for channel_id in chunk.message_index_offsets:
                    self.heads(chunk, self.channels[channel_id].topic, data)
        except (InputError, KeyError):
            return False
        return self.complete

    def summary(self) -> FileSummary:
        """Return the counts and the time span of the file."""
        statistics = self._summary.statistics
        assert statistics is not None, "the writer makes them"
        counts = {t: statistics.channel_message_counts.get(i, 0) for t, i in self.topics.items()}
        start_ns, end_ns = statistics.message_start_time, statistics.message_end_time
        return FileSummary(self.path.name, start_ns, end_ns, counts)

    def _open(self) -> BinaryIO:
        return self.path.open("rb") if self._rewritten is None else BytesIO(self._rewritten)


def rewrite(source: BinaryIO, target: BinaryIO) -> Rewritten:
    """Write what can be read of a file as a whole one.

    Every chunk that fits its checksum is kept, also behind a broken one. Messages are lost where
    the name of their topic is: the first chunk announces all topics, and only the index, which a
    cut-off file lacks, does so again.
    """
    writer = Writer(target)
    writer.start(profile="ros2")
    schemas: dict[int, int] = {0: 0}
    channels: dict[int, int] = {}
    n_messages = n_lost_chunks = 0
    for record in _records(source):
        if isinstance(record, Schema) and record.id not in schemas:
            schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
        elif isinstance(record, Channel) and record.id not in channels:
            channels[record.id] = writer.register_channel(
                record.topic, record.message_encoding, schemas[record.schema_id], record.metadata
            )
        elif isinstance(record, Metadata):
            writer.add_metadata(record.name, record.metadata)
        elif isinstance(record, Attachment):
            writer.add_attachment(
                record.create_time, record.log_time, record.name, record.media_type, record.data
            )
        n_lost_chunks += isinstance(record, Chunk)
    for record in _records(source):
        if isinstance(record, Message) and record.channel_id in channels:
            writer.add_message(
                channels[record.channel_id],
                record.log_time,
                record.data,
                record.publish_time,
                record.sequence,
            )
            n_messages += 1
    writer.finish()
    return Rewritten(n_messages, n_lost_chunks)


def _records(stream: BinaryIO) -> Iterator[McapRecord]:
    """Yield the records of a file and those in its chunks; of a chunk that is broken, itself."""
    stream.seek(0)
    with suppress(*_BROKEN):
        for record in StreamReader(stream, emit_chunks=True).records:
            inside: list[McapRecord] = [record]
            if isinstance(record, Chunk):
                with suppress(*_BROKEN):
                    inside = breakup_chunk(record, validate_crc=True)
            yield from inside


def _is_indexed(stream: BinaryIO) -> bool:
    """Whether a file ends with an index that has its checksum."""
    try:
        stream.seek(-FOOTER_SIZE - MAGIC_SIZE, 2)
        *_, footer = StreamReader(stream, skip_magic=True).records
        if not isinstance(footer, Footer) or not footer.summary_start:
            return False
        stream.seek(footer.summary_start)
        covered = stream.read()[: -MAGIC_SIZE - 4]  # the checksum itself is the footer's end
    except (*_BROKEN, OSError):
        return False
    return footer.summary_crc in (0, zlib.crc32(covered))


def rows_at(data: np.ndarray, starts: np.ndarray, n_bytes: int) -> np.ndarray:
    """Return the n_bytes behind each start in data (n,) uint8: (n, n_bytes) uint8."""
    # As one item per window each row is copied at once, which is ten times quicker than by byte.
    windows = np.ndarray((max(0, len(data) - n_bytes + 1),), f"V{n_bytes}", data, strides=(1,))
    return windows[starts].view(np.uint8).reshape(len(starts), n_bytes)
