"""Random access to one .mcap file, whole or cut off at any byte.

A whole file is read through the index at its end. A cut-off one has no index; its records are
walked from the start up to the last complete chunk. The MCAP format: https://mcap.dev/spec.
"""

import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import zstandard
from mcap.data_stream import ReadDataStream
from mcap.exceptions import McapError
from mcap.opcode import Opcode
from mcap.reader import SeekingReader
from mcap.records import (
    Attachment,
    Channel,
    Chunk,
    ChunkIndex,
    Message,
    Metadata,
    Schema,
    Statistics,
)
from mcap.stream_reader import get_chunk_data_stream

from experiment_manager.bag.metadata import FileSummary
from lockstep.errors import InputError

_INDEX_HEADER = struct.Struct("<BQHI")  # opcode, length of the body, channel, bytes of entries
_FOOTER = struct.Struct("<BQQQI")  # opcode, length, start of the summary, of its offsets, checksum
_MAGIC = b"\x89MCAP0\r\n"
_RECORD = struct.Struct("<BQ")  # opcode, length of the body
_MESSAGE = struct.Struct("<HIQQ")  # channel, sequence, log time, publish time
_LEAST_BYTES = 2 * len(_MAGIC) + _FOOTER.size
_CHUNK_LIMIT_BYTES = 1 << 31
# A message index entry; and what a message record is made of before its data.
INDEX_ENTRY = np.dtype([("log_time", "<u8"), ("offset", "<u8")])
MESSAGE_HEADER_BYTES = _RECORD.size + _MESSAGE.size
_MESSAGE_HEAD = np.dtype(
    [
        ("opcode", "u1"),
        ("length", "<u8"),
        ("channel", "<u2"),
        ("sequence", "<u4"),
        ("log_time", "<u8"),
        ("publish_time", "<u8"),
    ]
)
# What broken bytes make of the readers of records, checksums and compressed blocks.
_BROKEN = (
    McapError,
    EOFError,
    struct.error,
    ValueError,
    OverflowError,
    MemoryError,
    RuntimeError,
    zstandard.ZstdError,
)


@dataclass(frozen=True)
class IndexedChunk:
    """Where a chunk is, and its messages: {channel id: entries (n,) of INDEX_ENTRY}."""

    offset: int
    n_bytes: int
    entries: Callable[[int], np.ndarray]
    channel_ids: frozenset[int]


@dataclass
class McapFile:
    """One .mcap file: its records by kind, and its messages chunk by chunk.

    complete: it ends as it should. channels, schemas: by id. metadata: {record name: {key: text}}.
    attachments: {name: content}. n_lost_bytes: what lies behind the last complete record,
    and in broken ones that are no chunks.
    """

    path: Path
    complete: bool = False
    channels: dict[int, Channel] = field(default_factory=dict)
    schemas: dict[int, Schema] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    attachments: dict[str, bytes] = field(default_factory=dict)
    chunks: list[IndexedChunk] = field(default_factory=list)
    n_lost_bytes: int = 0
    _statistics: Statistics | None = None

    @classmethod
    def open(cls, path: Path, *, beyond_damage: bool = False) -> "McapFile":
        """Read the index of a file, or walk its records when it has none.

        beyond_damage: do not end a walk at a broken record; broken chunks are then there, too,
        without messages. Raises InputError when the path is no file or does not begin as an MCAP
        file.
        """
        if not path.is_file():
            raise InputError(f"expected an .mcap file, {path} is none")
        file = cls(path)
        with path.open("rb") as stream:
            # A kill may leave less than the first eight bytes: a file cut off before anything.
            if not _MAGIC.startswith(stream.read(len(_MAGIC))):
                raise InputError(f"{path}: expected an MCAP file, its first bytes are others")
            if not file._read_summary(stream):
                file._walk(stream, beyond_damage=beyond_damage)
        return file

    def channel_id(self, topic: str) -> int | None:
        """Return the channel of a topic, None when the file has none."""
        return next((i for i, channel in self.channels.items() if channel.topic == topic), None)

    def entries(self, chunk: IndexedChunk, topic: str) -> np.ndarray:
        """Return the stamps and positions of a topic's messages in a chunk: (n,) of INDEX_ENTRY."""
        channel_id = self.channel_id(topic)
        return np.zeros(0, INDEX_ENTRY) if channel_id is None else chunk.entries(channel_id)

    def type_name(self, channel_id: int) -> str:
        """Return the message type of a channel, such as sensor_msgs/msg/Image."""
        schema = self.schemas.get(self.channels[channel_id].schema_id)
        return schema.name if schema else ""

    def read_chunk(self, chunk: IndexedChunk) -> np.ndarray:
        """Return the records of a chunk, decompressed: (n_bytes,) uint8.

        Raises InputError when the chunk does not fit its checksum, or its index does not fit it:
        what is returned may be trusted.
        """
        records = np.frombuffer(self._chunk_data(chunk), np.uint8)
        for channel_id in chunk.channel_ids:
            if not _index_fits(records, chunk.entries(channel_id), channel_id):
                raise InputError(f"{self.path}: broken index of the chunk at byte {chunk.offset}")
        return records

    def messages(self, chunk: IndexedChunk) -> list[Message]:
        """Return the messages of a chunk, found without its index.

        Raises InputError when the chunk does not fit its checksum.
        """
        data = self._chunk_data(chunk)
        return [
            Message.read(ReadDataStream(BytesIO(body)), len(body))
            for opcode, _, body in _records(data)
            if opcode == Opcode.MESSAGE
        ]

    def _chunk_data(self, chunk: IndexedChunk) -> bytes:
        try:
            with self.path.open("rb") as stream:
                stream.seek(chunk.offset + _RECORD.size)
                return _chunk_data(Chunk.read(ReadDataStream(stream)))
        except _BROKEN as error:
            raise InputError(
                f"{self.path}: broken chunk at byte {chunk.offset}: {error}"
            ) from error

    def log_times_ns(self, channel_id: int) -> np.ndarray:
        """Return the stamps of all messages of a channel (n,) int64, in the file's order."""
        times = [c.entries(channel_id)["log_time"] for c in self.chunks]
        return np.concatenate([np.zeros(0, np.uint64), *times]).astype(np.int64)

    def last_stamps_ns(self) -> dict[str, int]:
        """Return the greatest stamp of each topic that has messages."""
        last: dict[str, int] = {}
        for channel_id, channel in self.channels.items():
            for chunk in reversed(self.chunks):
                if channel_id in chunk.channel_ids:
                    last[channel.topic] = int(chunk.entries(channel_id)["log_time"].max())
                    break
        return last

    def summary(self) -> FileSummary:
        """Return the counts and the time span of the file."""
        topics = {i: channel.topic for i, channel in self.channels.items()}
        if self._statistics is not None:
            found = self._statistics.channel_message_counts
            start_ns, end_ns = (
                self._statistics.message_start_time,
                self._statistics.message_end_time,
            )
            counts = {topic: found.get(i, 0) for i, topic in topics.items()}
            return FileSummary(self.path.name, start_ns, end_ns, counts)
        times = {topic: self.log_times_ns(i) for i, topic in topics.items()}
        all_ns = np.concatenate([np.zeros(0, np.int64), *times.values()])
        return FileSummary(
            name=self.path.name,
            start_ns=int(all_ns.min()) if len(all_ns) else 0,
            end_ns=int(all_ns.max(initial=0)),
            message_counts={topic: len(t) for topic, t in times.items()},
        )

    def _read_summary(self, stream: BinaryIO) -> bool:
        size = stream.seek(0, 2)
        stream.seek(max(0, size - len(_MAGIC)))
        if stream.read() != _MAGIC or size < _LEAST_BYTES or not _summary_fits(stream, size):
            return False
        stream.seek(0)
        try:
            reader = SeekingReader(stream)
            summary = reader.get_summary()
            if summary is None or not _is_indexed(summary):
                return False
            metadata = {r.name: dict(r.metadata) for r in reader.iter_metadata()}
            attachments = {r.name: r.data for r in reader.iter_attachments()}
        except _BROKEN:
            return False
        self._statistics = summary.statistics
        self.metadata, self.attachments = metadata, attachments
        self.channels = dict(summary.channels)
        self.schemas = dict(summary.schemas)
        for index in sorted(summary.chunk_indexes, key=lambda i: i.chunk_start_offset):
            self.chunks.append(self._indexed(index))
        self.complete = True
        return True

    def _indexed(self, index: ChunkIndex) -> IndexedChunk:
        def entries(channel_id: int) -> np.ndarray:
            offset = index.message_index_offsets.get(channel_id)
            if offset is None:
                return _no_entries(channel_id)
            with self.path.open("rb") as stream:
                stream.seek(offset)
                head = stream.read(_INDEX_HEADER.size)
                if len(head) == _INDEX_HEADER.size:
                    opcode, _, found_id, n_bytes = _INDEX_HEADER.unpack(head)
                    body = stream.read(min(n_bytes, _CHUNK_LIMIT_BYTES))
                    whole = len(body) == n_bytes and not n_bytes % INDEX_ENTRY.itemsize
                    if (opcode, found_id, whole) == (Opcode.MESSAGE_INDEX, channel_id, True):
                        return np.frombuffer(body, INDEX_ENTRY)
            raise InputError(f"{self.path}: broken message index at byte {offset}")

        return IndexedChunk(
            index.chunk_start_offset,
            index.chunk_length,
            entries,
            frozenset(index.message_index_offsets),
        )

    def _walk(self, stream: BinaryIO, *, beyond_damage: bool) -> None:
        end = stream.seek(0, 2)
        position = stream.seek(len(_MAGIC))
        while position + _RECORD.size <= end:
            opcode, length = _RECORD.unpack(stream.read(_RECORD.size))
            following = position + _RECORD.size + length
            if following > end:
                break
            try:
                self._take(opcode, position, stream, length)
            except _BROKEN:
                # Where nothing begins that can be right, no record behind it is found either.
                if not beyond_damage or opcode not in set(Opcode):
                    break
                if opcode == Opcode.CHUNK:
                    self.chunks.append(
                        IndexedChunk(position, following - position, _no_entries, frozenset())
                    )
                else:
                    self.n_lost_bytes += following - position
            position = stream.seek(following)
        self.n_lost_bytes += end - position

    def _take(self, opcode: int, position: int, stream: BinaryIO, length: int) -> None:
        if opcode == Opcode.CHUNK:
            chunk = Chunk.read(ReadDataStream(stream))
            n_bytes = _RECORD.size + length
            self.chunks.append(self._scanned(position, n_bytes, _chunk_data(chunk)))
        elif opcode == Opcode.METADATA:
            metadata = Metadata.read(ReadDataStream(stream))
            self.metadata[metadata.name] = dict(metadata.metadata)
        elif opcode == Opcode.ATTACHMENT:
            attachment = Attachment.read(ReadDataStream(stream))
            self.attachments[attachment.name] = attachment.data
        elif opcode not in set(Opcode) and opcode < 0x80:
            # Opcodes from 0x80 are for applications; below, nothing unknown can be right.
            raise McapError(f"unknown record {opcode} of {length} bytes at {position}")

    def _scanned(self, offset: int, n_bytes: int, data: bytes) -> IndexedChunk:
        found: dict[int, list[tuple[int, int]]] = {}
        for opcode, position, body in _records(data):
            if opcode == Opcode.MESSAGE:
                channel_id, _, log_time, _ = _MESSAGE.unpack_from(body)
                found.setdefault(channel_id, []).append((log_time, position))
            elif opcode == Opcode.CHANNEL:
                channel = Channel.read(ReadDataStream(BytesIO(body)))
                self.channels[channel.id] = channel
            elif opcode == Opcode.SCHEMA:
                schema = Schema.read(ReadDataStream(BytesIO(body)))
                self.schemas[schema.id] = schema
        entries = {i: np.array(pairs, dtype=INDEX_ENTRY) for i, pairs in found.items()}
        return IndexedChunk(
            offset, n_bytes, lambda i: entries.get(i, _no_entries(i)), frozenset(entries)
        )


def _no_entries(channel_id: int) -> np.ndarray:
    return np.zeros(0, INDEX_ENTRY)


def _summary_fits(stream: BinaryIO, size: int) -> bool:
    """Whether the index at the end of a file of that size has its checksum."""
    stream.seek(size - len(_MAGIC) - _FOOTER.size)
    footer = stream.read(_FOOTER.size)
    opcode, _, start, _, checksum = _FOOTER.unpack(footer)
    if opcode != Opcode.FOOTER or not len(_MAGIC) <= start < size:
        return False
    stream.seek(start)
    summary = stream.read(size - len(_MAGIC) - _FOOTER.size - start)
    covered = footer[: _FOOTER.size - 4]
    return checksum == 0 or zlib.crc32(covered, zlib.crc32(summary)) == checksum


def _index_fits(records: np.ndarray, entries: np.ndarray, channel_id: int) -> bool:
    """Whether each entry (n,) leads to a message of the channel with the entry's stamp."""
    offsets = entries["offset"].astype(np.int64)
    if (offsets > len(records) - MESSAGE_HEADER_BYTES).any() or (offsets < 0).any():
        return False
    heads = np.ndarray(
        (max(0, len(records) - MESSAGE_HEADER_BYTES + 1),), _MESSAGE_HEAD, records, strides=(1,)
    )[offsets]
    return bool(
        (heads["opcode"] == Opcode.MESSAGE).all()
        and (heads["channel"] == channel_id).all()
        and (heads["log_time"] == entries["log_time"]).all()
        and (heads["length"] <= len(records) - offsets - _RECORD.size).all()
    )


def _is_indexed(summary: Any) -> bool:
    """Whether the summary names all channels and the messages of all chunks."""
    counted = summary.statistics is not None and (
        summary.statistics.chunk_count == len(summary.chunk_indexes)
    )
    named = all(
        index.message_index_offsets and set(index.message_index_offsets) <= set(summary.channels)
        for index in summary.chunk_indexes
    )
    return bool(counted and named)


def _chunk_data(chunk: Chunk) -> bytes:
    if chunk.uncompressed_size > _CHUNK_LIMIT_BYTES:
        raise McapError(f"a chunk of {chunk.uncompressed_size} bytes cannot be right")
    stream, size = get_chunk_data_stream(chunk)
    data = stream.read(size) if size else b""
    if len(data) != chunk.uncompressed_size:
        raise McapError(f"a chunk has {len(data)} bytes, {chunk.uncompressed_size} announced")
    if chunk.uncompressed_crc and zlib.crc32(data) != chunk.uncompressed_crc:
        raise McapError("a chunk does not fit its checksum")
    return data


def _records(data: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Yield (opcode, position, body) of each record of a chunk."""
    position = 0
    while position < len(data):
        opcode, length = _RECORD.unpack_from(data, position)
        body = position + _RECORD.size
        yield opcode, position, data[body : body + length]
        position = body + length
