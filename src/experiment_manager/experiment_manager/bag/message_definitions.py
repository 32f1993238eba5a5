"""Message definitions as a bag carries them: text with all dependencies, and the type's hash."""

import json
import os
import re
import sys
from dataclasses import dataclass
from pathlib import Path

from lockstep.errors import InputError

_SEPARATOR = "=" * 80
_PRIMITIVES = re.compile(r"^(bool|byte|char|w?string|float(32|64)|u?int(8|16|32|64))$")
_FIELD = re.compile(r"^\s*([A-Za-z][\w/]*)(<=\d+)?(\[[^\]]*\])?\s+[A-Za-z]\w*")


@dataclass(frozen=True)
class MessageDefinition:
    """A type such as sensor_msgs/msg/JointState.

    text: its .msg file and those of all types it contains, as the MCAP profile ``ros2`` wants them
    (schema encoding ``ros2msg``); type_hash: the REP-2011 hash, "RIHS01_...".
    """

    type_name: str
    text: str
    type_hash: str


def message_definition(type_name: str) -> MessageDefinition:
    """Return the definition of an installed type, for example sensor_msgs/msg/JointState.

    Raises InputError when the name has another form or the type is not installed.
    """
    parts = type_name.split("/")
    if len(parts) != 3 or parts[1] != "msg":
        raise InputError(f"expected a type such as sensor_msgs/msg/Image, got {type_name!r}")
    path = _definition_path(parts[0], parts[2])
    text = path.read_text(encoding="utf-8")
    for dependency in _dependencies(parts[0], text):
        package, name = dependency.split("/")
        body = _definition_path(package, name).read_text(encoding="utf-8")
        text = f"{text.rstrip()}\n\n{_SEPARATOR}\nMSG: {dependency}\n{body}"
    return MessageDefinition(type_name, text, _type_hash(path.with_suffix(".json"), type_name))


def _definition_path(package: str, name: str) -> Path:
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    # Wheels install the definitions under the prefix of the virtual environment.
    for prefix in [*prefixes, sys.prefix]:
        path = Path(prefix) / "share" / package / "msg" / f"{name}.msg"
        if path.is_file():
            return path
    raise InputError(
        f"expected an installed message type, got {package}/msg/{name}: its definition is not "
        f"below {', '.join([*prefixes, sys.prefix])}"
    )


def _dependencies(package: str, text: str) -> list[str]:
    """Return the types (package/Name) that a definition contains, each once, deepest last."""
    found: list[str] = []
    pending = [(package, text)]
    while pending:
        owner, body = pending.pop(0)
        for name in _field_types(body):
            full_name = name if "/" in name else f"{owner}/{name}"
            if full_name not in found:
                found.append(full_name)
                inner = full_name.split("/")
                pending.append((inner[0], _definition_path(*inner).read_text(encoding="utf-8")))
    return found


def _field_types(text: str) -> list[str]:
    lines = (line.split("#", 1)[0] for line in text.splitlines())
    matches = (_FIELD.match(line) for line in lines)
    return [m.group(1) for m in matches if m and not _PRIMITIVES.match(m.group(1))]


def _type_hash(description: Path, type_name: str) -> str:
    hashes = json.loads(description.read_text(encoding="utf-8"))["type_hashes"]
    return next(str(h["hash_string"]) for h in hashes if h["type_name"] == type_name)
