"""Message definitions as a bag carries them: text with all dependencies, and the type's hash."""

import json
import os
import sys
from dataclasses import dataclass
from pathlib import Path

from lockstep import InputError

_SEPARATOR = "=" * 80


@dataclass(frozen=True)
class MessageDefinition:
    """A type such as sensor_msgs/msg/JointState.

    text: its .msg file and those of all types it contains, as the MCAP profile ``ros2`` wants them
    (schema encoding ``ros2msg``); type_hash: the REP-2011 hash, "RIHS01_...".
    """

    text: str
    type_hash: str


def message_definition(type_name: str) -> MessageDefinition:
    """Return the definition of an installed type, for example sensor_msgs/msg/JointState.

    Raises InputError when the name has another form or the type is not installed.
    """
    parts = type_name.split("/")
    if len(parts) != 3 or parts[1] != "msg":
        raise InputError(f"expected a type such as sensor_msgs/msg/Image, got {type_name!r}")
    path = _definition_path(type_name)
    described = json.loads(path.with_suffix(".json").read_text(encoding="utf-8"))
    # Of the type and of all that it contains.
    hashes = {str(h["type_name"]): str(h["hash_string"]) for h in described["type_hashes"]}
    text = path.read_text(encoding="utf-8")
    for contained in sorted(hashes.keys() - {type_name}):
        body = _definition_path(contained).read_text(encoding="utf-8")
        name = contained.replace("/msg/", "/")
        text = f"{text.rstrip()}\n\n{_SEPARATOR}\nMSG: {name}\n{body}"
    return MessageDefinition(text, hashes[type_name])


def _definition_path(type_name: str) -> Path:
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    # Wheels install the definitions under the prefix of the virtual environment.
    for prefix in [*prefixes, sys.prefix]:
        path = Path(prefix) / "share" / f"{type_name}.msg"
        if path.is_file():
            return path
    raise InputError(
        f"expected an installed message type, got {type_name}: its definition is not "
        f"below {', '.join([*prefixes, sys.prefix])}"
    )
