"""metadata.yaml of a bag directory, in the form that rosbag2 of ROS 2 Jazzy writes (version 9)."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from lockstep import InputError
from lockstep.files.durable_files import replace_file

METADATA_FILE = "metadata.yaml"
# In each MCAP file: the record that names the run, and the attachment with its configuration.
RUN_METADATA = "run"
CONFIGURATION_ATTACHMENT = "config.yaml"
_NEVER = {"sec": 9223372036, "nsec": 854775807}  # rmw's infinite duration
_NO_TIME_NS = 2**63 - 1  # what rosbag2 writes as the start of an empty bag
# Of libyaml where PyYAML has it: each checkpoint waits for what is written.
_DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)


# How the graph's publishers offer their topics (lockstep.wire.qos), in rosbag2's YAML, which both
# metadata.yaml and the channels carry.
OFFERED_QOS = yaml.safe_dump(
    [
        {
            "history": "keep_last",
            "depth": 64,
            "reliability": "reliable",
            "durability": "volatile",
            "deadline": dict(_NEVER),
            "lifespan": dict(_NEVER),
            "liveliness": "automatic",
            "liveliness_lease_duration": dict(_NEVER),
            "avoid_ros_namespace_conventions": False,
        }
    ],
    sort_keys=False,
).rstrip()


@dataclass(frozen=True)
class Topic:
    """A topic of a bag: what its messages are, and how they were offered, as OFFERED_QOS."""

    name: str
    type_name: str
    type_hash: str
    qos: str = OFFERED_QOS


@dataclass(frozen=True)
class FileSummary:
    """One .mcap file: its name, time span (first and last stamp) and counts by topic name."""

    name: str
    start_ns: int
    end_ns: int
    message_counts: Mapping[str, int]

    @property
    def n_messages(self) -> int:
        """Messages of all topics."""
        return sum(self.message_counts.values())

    def span(self) -> dict[str, Any]:
        """Return the start, duration and number of messages as rosbag2 names them."""
        empty = not self.n_messages
        return {
            "starting_time": {"nanoseconds_since_epoch": _NO_TIME_NS if empty else self.start_ns},
            "duration": {"nanoseconds": 0 if empty else self.end_ns - self.start_ns},
            "message_count": self.n_messages,
        }


def bag_information(
    topics: Sequence[Topic], files: Sequence[FileSummary], custom_data: Mapping[str, str]
) -> dict[str, Any]:
    """Return what metadata.yaml holds under ``rosbag2_bagfile_information``."""
    filled = [file for file in files if file.n_messages]
    counts = {t.name: sum(f.message_counts.get(t.name, 0) for f in files) for t in topics}
    whole = FileSummary(
        name="",
        start_ns=min((file.start_ns for file in filled), default=0),
        end_ns=max((file.end_ns for file in filled), default=0),
        message_counts=counts,
    )
    span = whole.span()
    return {
        "version": 9,
        "storage_identifier": "mcap",
        "duration": span["duration"],
        "starting_time": span["starting_time"],
        "message_count": span["message_count"],
        "topics_with_message_count": [
            {"topic_metadata": _topic_metadata(topic), "message_count": counts[topic.name]}
            for topic in topics
        ],
        "compression_format": "",
        "compression_mode": "",
        "relative_file_paths": [file.name for file in files],
        "files": [{"path": file.name, **file.span()} for file in files],
        "custom_data": dict(custom_data) or None,
        "ros_distro": "jazzy",
    }


def _topic_metadata(topic: Topic) -> dict[str, Any]:
    return {
        "name": topic.name,
        "type": topic.type_name,
        "serialization_format": "cdr",
        "offered_qos_profiles": deepcopy(_profiles(topic.qos)),  # of one object YAML has aliases
        "type_description_hash": topic.type_hash,
    }


@cache
def _profiles(qos: str) -> Any:
    return yaml.safe_load(qos)


def read_information(directory: Path) -> dict[str, Any]:
    """Return what the metadata.yaml of a bag holds, {"relative_file_paths": []} without one.

    Raises InputError for what rosbag2 would not have written.
    """
    path = directory / METADATA_FILE
    if not path.is_file():
        return {"relative_file_paths": []}
    try:
        document = yaml.safe_load(path.read_text(encoding="utf-8"))
        information = dict(document["rosbag2_bagfile_information"])
        information["relative_file_paths"] = list(information["relative_file_paths"])
    except (yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        raise InputError(f"{path}: expected what rosbag2 writes, got {error}") from error
    return information


def write_metadata(directory: Path, information: Mapping[str, Any]) -> None:
    """Replace the metadata.yaml of a bag as a whole: a reader sees the old or the new one."""
    document = {"rosbag2_bagfile_information": dict(information)}
    text = yaml.dump(document, Dumper=_DUMPER, sort_keys=False)
    replace_file(directory / METADATA_FILE, text.encode())
