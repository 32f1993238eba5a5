"""Makes a bag whole again after a kill or damage: what can be read is kept, the rest goes."""

import os
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from mcap.writer import Writer

from experiment_manager.bag.mcap_file import IndexedChunk, McapFile
from experiment_manager.bag.metadata import (
    OFFERED_QOS,
    RUN_METADATA,
    Topic,
    bag_information,
    read_information,
    write_metadata,
)
from experiment_manager.bag.reader import Bag
from lockstep.durable_files import sync_directory
from lockstep.errors import InputError


@dataclass(frozen=True)
class Repair:
    """What was done to one file.

    n_messages: kept; n_broken_chunks: lost; n_lost_bytes: in these and behind the last record;
    n_unnamed: messages that are lost with the name of their topic.
    """

    name: str
    n_messages: int
    n_broken_chunks: int
    n_lost_bytes: int
    n_unnamed: int


def repair_bag(path: Path) -> list[Repair]:
    """Rewrite each cut-off or damaged file of a bag and its metadata.yaml; return what was done.

    The messages of every chunk that fits its checksum are kept, also behind a broken one, except
    those whose topic has lost its name: the first chunk announces all topics, and only the index,
    which a cut-off file lacks, does so again. The metadata is only rewritten when it does not fit
    the files. Each file is replaced as a whole.
    Raises InputError when there is no bag at path.
    """
    bag = Bag(path)
    repairs = [_rewrite(file.path) for file in bag.files if not _is_whole(file)]
    if path.is_dir():
        _rewrite_metadata(path)
    return repairs


def _is_whole(file: McapFile) -> bool:
    try:
        for chunk in file.chunks:
            file.read_chunk(chunk)
    except InputError:
        return False
    return file.complete


def _rewrite(path: Path) -> Repair:
    file = McapFile.open(path, beyond_damage=True)
    beside = path.with_name(path.name + ".part")
    with beside.open("wb") as stream:
        n_messages, n_unnamed, broken = _copy(file, stream)
        stream.flush()
        os.fsync(stream.fileno())
    beside.replace(path)
    sync_directory(path.parent)
    n_lost_bytes = file.n_lost_bytes + sum(chunk.n_bytes for chunk in broken)
    return Repair(path.name, n_messages, len(broken), n_lost_bytes, n_unnamed)


def _copy(file: McapFile, stream: BinaryIO) -> tuple[int, int, list[IndexedChunk]]:
    """Write what can be read; return how many messages are kept and unnamed, and broken chunks."""
    writer = Writer(stream)
    writer.start(profile="ros2")
    channels = _announce(file, writer)
    n_messages, n_unnamed, broken = 0, 0, []
    for chunk in file.chunks:
        try:
            messages = file.messages(chunk)
        except InputError:
            broken.append(chunk)
            continue
        # A topic that was announced in a broken chunk has no name.
        known = [m for m in messages if m.channel_id in channels]
        for m in known:
            channel = channels[m.channel_id]
            writer.add_message(channel, m.log_time, m.data, m.publish_time, m.sequence)
        n_messages += len(known)
        n_unnamed += len(messages) - len(known)
    writer.finish()
    return n_messages, n_unnamed, broken


def _announce(file: McapFile, writer: Writer) -> dict[int, int]:
    """Write all but the messages of a file; return its channels' numbers in the new one."""
    for name, record in file.metadata.items():
        writer.add_metadata(name, record)
    for name, content in file.attachments.items():
        writer.add_attachment(0, 0, name, "application/yaml", content)
    schemas = {
        i: writer.register_schema(schema.name, schema.encoding, schema.data)
        for i, schema in file.schemas.items()
    }
    return {
        i: writer.register_channel(
            channel.topic, channel.message_encoding, schemas[channel.schema_id], channel.metadata
        )
        for i, channel in file.channels.items()
    }


def _rewrite_metadata(directory: Path) -> None:
    bag = Bag(directory)
    topics: dict[str, Topic] = {}
    for file in bag.files:
        for i, channel in file.channels.items():
            topics[channel.topic] = Topic(
                channel.topic,
                file.type_name(i),
                channel.metadata.get("topic_type_hash", ""),
                channel.metadata.get("offered_qos_profiles") or OFFERED_QOS,
            )
    information = bag_information(
        list(topics.values()),
        [file.summary() for file in bag.files],
        bag.metadata.get(RUN_METADATA, {}),
    )
    if read_information(directory) != information:
        write_metadata(directory, information)
