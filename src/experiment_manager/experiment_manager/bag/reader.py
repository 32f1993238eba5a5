"""Reads the columns and the pictures of a bag, quickly, and as far as a cut-off file goes."""

import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from experiment_manager.bag.mcap_file import HEAD, HEAD_BYTES_IN_LENGTH, McapFile, rows_at
from experiment_manager.bag.metadata import METADATA_FILE, read_information
from lockstep import InputError
from lockstep.wire.cdr import VectorLayout, image_array

_FIELDS = ("position", "velocity", "effort")


@dataclass(frozen=True)
class VectorTable:
    """All messages of a topic of named doubles, in the order of the bag.

    names: (k,). stamps_ns: (n,) int64. position, velocity, effort: (n, k) float64, or (n, 0) when
    the messages carry none; nan where a message does not have a name.
    """

    names: tuple[str, ...]
    stamps_ns: np.ndarray
    position: np.ndarray
    velocity: np.ndarray
    effort: np.ndarray

    def column(self, name: str) -> np.ndarray:
        """Return the positions (n,) of one name."""
        if name not in self.names:
            raise InputError(f"expected one of {', '.join(self.names)}, got {name!r}")
        return self.position[:, self.names.index(name)]

    def at(self, stamps_ns: np.ndarray) -> np.ndarray:
        """Return the rows (n,) that hold the given stamps, -1 where there is none."""
        if not len(self.stamps_ns):
            return np.full(len(stamps_ns), -1)
        order = np.argsort(self.stamps_ns, kind="stable")
        nearest = np.searchsorted(self.stamps_ns, stamps_ns, sorter=order)
        rows = order[np.minimum(nearest, len(order) - 1)]
        return np.where(self.stamps_ns[rows] == stamps_ns, rows, -1)


class Bag:
    """A bag directory or a single .mcap file, opened for reading.

    Example:
        >>> from experiment_manager import Bag
        >>> bag = Bag("runs/first/bag")
        >>> truth = bag.vectors("ground_truth")["ground_truth"]
        >>> float(truth.column("object_distance_m")[0])
        2.0
        >>> stamp_ns, picture = next(bag.images("left/image_raw"))
        >>> picture.dtype
        dtype('uint8')
    """

    def __init__(self, path: str | Path) -> None:
        """Read the index of each file; InputError when there is no bag at path."""
        self.path = Path(path)
        self.files = [McapFile(file) for file in _files(self.path)]

    @cached_property
    def types(self) -> dict[str, str]:
        """{topic: message type} of all topics, also of those without messages."""
        return {
            topic: file.type_name(channel_id)
            for file in self.files
            for topic, channel_id in file.topics.items()
        }

    @cached_property
    def metadata(self) -> dict[str, dict[str, str]]:
        """Metadata records {name: {key: text}}; the last file's word counts."""
        return {name: record for file in self.files for name, record in file.metadata.items()}

    def attachment(self, name: str) -> bytes:
        """Return the content of an attachment; InputError when no file has it."""
        for file in reversed(self.files):
            if name in file.attachments:
                return file.attachments[name]
        raise InputError(f"bag {self.path}: expected an attachment {name}, it has none")

    def topic(self, name: str) -> str:
        """Return the full name of a topic, given that or its last parts.

        "ground_truth" finds "/ground_truth" as well as "/robot_1/ground_truth". Raises InputError
        when no topic or more than one fits.
        """
        full_name = name if name.startswith("/") else f"/{name}"
        if full_name in self.types:
            return full_name
        found = [topic for topic in self.types if topic.endswith(full_name)]
        if len(found) != 1:
            raise InputError(
                f"bag {self.path}: expected one topic {name!r}, found {', '.join(found) or 'none'}"
                f" among {', '.join(self.types) or 'no topics'}"
            )
        return found[0]

    def has(self, name: str) -> bool:
        """Whether a topic was announced, by its full name or its last parts."""
        return any(topic == name or topic.endswith("/" + name) for topic in self.types)

    def stamps_ns(self, topic: str) -> np.ndarray:
        """Return the stamps (n,) of a topic's messages, in the order of the bag."""
        name = self.topic(topic)
        return np.concatenate([file.stamps_ns(name) for file in self.files])

    def vectors(self, *topics: str) -> dict[str, VectorTable]:
        """Return the tables of several topics of JointState, in one pass over the bag.

        The keys are the topics as asked for. Raises InputError for a topic of another type or a
        broken chunk.
        """
        names = {topic: self.topic(topic) for topic in topics}
        for name in names.values():
            if self.types[name] != "sensor_msgs/msg/JointState":
                raise InputError(
                    f"{name}: expected sensor_msgs/msg/JointState, got {self.types[name]}"
                )
        parts: dict[str, list[VectorTable]] = {topic: [] for topic in topics}
        for file in self.files:
            for chunk in file.chunks(*names.values()):
                data = file.read_chunk(chunk)
                for topic, name in names.items():
                    parts[topic].extend(_tables(data, *file.heads(chunk, name, data)))
        # One topic after the other: a full run's parts and whole tables would fill a gigabyte.
        return {topic: _joined(parts.pop(topic)) for topic in topics}

    def images(
        self, topic: str, stamps_ns: Iterable[int] | None = None
    ) -> Iterator[tuple[int, np.ndarray]]:
        """Yield (stamp, picture) of a topic of sensor_msgs/Image, in the order of the bag.

        stamps_ns: only these; None: all. Pictures: cdr.image_array.
        """
        for stamp, message in self.messages(topic, stamps_ns):
            yield stamp, image_array(message)

    def messages(
        self, topic: str, stamps_ns: Iterable[int] | None = None
    ) -> Iterator[tuple[int, bytes]]:
        """Yield (stamp, serialized message) of a topic, in the order of the bag.

        stamps_ns: only these; None: all.
        """
        name = self.topic(topic)
        wanted = None if stamps_ns is None else np.array(sorted(stamps_ns), np.int64)
        for file in self.files:
            for chunk in file.chunks(name):
                if wanted is not None and not np.isin(wanted, file.index(chunk, name)[:, 0]).any():
                    continue
                data = file.read_chunk(chunk)
                offsets, heads = file.heads(chunk, name, data)
                stamps = heads["log_time"].astype(np.int64)
                starts = offsets + HEAD.itemsize
                for stamp, start, n_bytes in zip(stamps, starts, _n_bytes(heads), strict=True):
                    if wanted is None or stamp in wanted:
                        yield int(stamp), data[start : start + n_bytes].tobytes()


def _files(path: Path) -> list[Path]:
    """Return the files of a bag: those metadata.yaml lists, then those written after it."""
    if path.is_file():
        return [path]
    if not path.is_dir():
        raise InputError(f"expected a bag directory or an .mcap file, {path} is neither")
    listed = [path / name for name in read_information(path)["relative_file_paths"]]
    missing = [file.name for file in listed if not file.is_file()]
    if missing:
        raise InputError(f"bag {path}: {METADATA_FILE} lists {', '.join(missing)}, not there")
    others = sorted(set(path.glob("*.mcap")) - set(listed), key=_natural)
    if not listed and not others:
        raise InputError(f"expected .mcap files in the bag directory {path}, there is none")
    return listed + others


def _natural(path: Path) -> list[tuple[int, str]]:
    """Sort key that puts bag_10 behind bag_9."""
    return [(int(part or 0), text) for text, part in re.findall(r"(\D*)(\d*)", path.name)]


def _tables(data: np.ndarray, offsets: np.ndarray, heads: np.ndarray) -> Iterator[VectorTable]:
    """Yield the messages of a chunk as tables, one for each run of messages of equal layout.

    offsets, heads: those of `McapFile.heads`.
    """
    starts, lengths = offsets + HEAD.itemsize, _n_bytes(heads)
    stamps_ns = heads["log_time"].astype(np.int64)
    while len(starts):
        n_bytes = int(lengths[0])
        layout = VectorLayout.of(data[starts[0] : starts[0] + n_bytes].tobytes())
        block_lengths = {block.length for block in layout.blocks} - {0, len(layout.names)}
        if block_lengths:
            raise InputError(
                f"expected a number for each of {len(layout.names)} names, "
                f"got {block_lengths.pop()}"
            )
        messages = rows_at(data, starts[: _n_leading(lengths == n_bytes)], n_bytes)
        n_same = _n_leading(layout.fits(messages, messages[0]))
        values = (layout.values(messages[:n_same], i) for i in range(len(_FIELDS)))
        yield VectorTable(layout.names, stamps_ns[:n_same], *values)
        starts, lengths, stamps_ns = starts[n_same:], lengths[n_same:], stamps_ns[n_same:]


def _n_bytes(heads: np.ndarray) -> np.ndarray:
    """Return how many bytes the messages (n,) behind their heads have."""
    return heads["length"].astype(np.int64) - HEAD_BYTES_IN_LENGTH


def _n_leading(true: np.ndarray) -> int:
    return len(true) if true.all() else int(true.argmin())


def _joined(tables: Sequence[VectorTable]) -> VectorTable:
    """Put tables below one another; the names are those of all, in order of appearance."""
    names = tuple(dict.fromkeys(name for table in tables for name in table.names))
    stamps = np.concatenate([np.zeros(0, np.int64), *(t.stamps_ns for t in tables)])
    return VectorTable(names, stamps, *(_stacked(tables, names, field) for field in _FIELDS))


def _stacked(tables: Sequence[VectorTable], names: Sequence[str], field: str) -> np.ndarray:
    parts: list[np.ndarray] = [getattr(table, field) for table in tables]
    n_columns = len(names) if any(values.shape[1] for values in parts) else 0
    stacked = np.full((sum(map(len, parts)), n_columns), np.nan)
    row = 0
    for table, values in zip(tables, parts, strict=True):
        columns = [names.index(name) for name in table.names[: values.shape[1]]]
        stacked[row : row + len(values), columns] = values
        row += len(values)
    return stacked
