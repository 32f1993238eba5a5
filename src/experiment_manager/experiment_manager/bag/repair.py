"""Completes a bag after a kill or damage: what can be read is written again, the rest goes."""

from pathlib import Path

from experiment_manager.bag.mcap_file import Rewritten, rewrite
from experiment_manager.bag.metadata import (
    OFFERED_QOS,
    RUN_METADATA,
    Topic,
    bag_information,
    read_information,
    write_metadata,
)
from experiment_manager.bag.reader import Bag
from lockstep.files.durable_files import replacement_of


def repair_bag(path: Path) -> dict[str, Rewritten]:
    """Rewrite each cut-off or damaged file of a bag; return what was kept and lost by file name.

    metadata.yaml is only rewritten when it does not fit the files. Each file is replaced as a
    whole. Raises InputError when there is no bag at path.
    """
    damaged = [file.path for file in Bag(path).files if not file.is_whole()]
    repairs = {file.name: _repair(file) for file in damaged}
    if path.is_dir():
        _rewrite_metadata(path)
    return repairs


def _repair(path: Path) -> Rewritten:
    with path.open("rb") as source, replacement_of(path) as target:
        return rewrite(source, target)


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
