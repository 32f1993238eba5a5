"""YAML as people write it in profiles, sweeps, schedules, parameter files and --set: YAML 1.2.

Numbers are in decimal notation, and null, true and false in lower case; the rest is text. What is
written here is the same for ROS, which reads numbers as C does: 1e5 and 0x1 are none in YAML 1.1.

PyYAML reads YAML 1.1, in which 1e-5 is a text, 010 is eight, `on` is true, 1:30 is 90 and the last
of two equal keys silently wins.
"""

import math
import re
from typing import Any

import yaml

from lockstep.errors import InputError


class _Loader(yaml.SafeLoader):
    """Reads null, true, false and numbers in decimal notation; everything else is a text."""

    # None of YAML 1.1; those of YAML 1.2 follow below.
    yaml_implicit_resolvers = {}  # noqa: RUF012

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:
        """Refuse a mapping in which a key stands twice."""
        # A key that is a list or a mapping is for the base class to refuse.
        keys = [key for key, _ in node.value if isinstance(key, yaml.ScalarNode)]
        seen = set()
        for key in keys:
            if key.value in seen:
                line = key.start_mark.line + 1
                raise InputError(f"line {line}: expected each key once, got {key.value!r} twice")
            seen.add(key.value)
        return super().construct_mapping(node, deep)

    def construct_whole_number(self, node: yaml.ScalarNode) -> int:
        """Refuse leading zeros, which other readers take for octal numbers."""
        text = str(node.value)
        if re.match(r"[-+]?0\d", text):
            raise InputError(f"expected a number without leading zeros, got {text}")
        return int(text)


_NUMBER = r"[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?|[-+]?\.inf|\.nan"
for _tag, _pattern, _firsts in (
    ("null", r"~|null|", ["~", "n", ""]),
    ("bool", r"true|false", ["t", "f"]),
    ("int", r"[-+]?[0-9]+", list("-+0123456789")),
    ("float", _NUMBER, list("-+.0123456789")),
):
    _Loader.add_implicit_resolver(
        f"tag:yaml.org,2002:{_tag}", re.compile(rf"^(?:{_pattern})$"), _firsts
    )
_Loader.add_constructor("tag:yaml.org,2002:int", _Loader.construct_whole_number)


def load_yaml(text: str) -> Any:
    """Return what a YAML text holds.

    Raises InputError for text that is not YAML, keys that stand twice and leading zeros.
    """
    try:
        return yaml.load(text, _Loader)
    except InputError:
        raise
    except (yaml.YAMLError, ValueError) as error:  # ValueError: a number of thousands of digits
        raise InputError(f"expected YAML: {' '.join(str(error).split())}") from error


class _Dumper(yaml.SafeDumper):
    """Quotes each text that some reader of YAML takes for something else."""

    def represent_text(self, text: str) -> yaml.ScalarNode:
        """Refuse what no YAML file can have, such as the name of a file in Latin-1."""
        try:
            text.encode()
        except UnicodeEncodeError as error:
            raise InputError(f"expected a text in UTF-8, got {text!r}") from error
        # Quoted singly, a text of several lines would take several lines.
        style = '"' if "\n" in text else None
        return self.represent_scalar("tag:yaml.org,2002:str", text, style=style)


_Dumper.add_representer(str, _Dumper.represent_text)
_Dumper.add_implicit_resolver(
    "tag:yaml.org,2002:float",
    re.compile(r"^[-+.0-9]|^(?:y|n|inf.*|nan.*)$", re.IGNORECASE),
    list("-+.0123456789yYnNiI"),
)


def dump_yaml(document: Any) -> str:
    """Return the text of a YAML file; raises InputError for a text that is not in UTF-8."""
    return yaml.dump(document, Dumper=_Dumper, sort_keys=False)


def yaml_line(value: Any) -> str:
    """Return a value as YAML in one line, as -p NAME:=VALUE has it; errors as for dump_yaml."""
    quotes = '"' if isinstance(value, str) else None
    text = yaml.dump(
        value, Dumper=_Dumper, default_flow_style=True, default_style=quotes, width=math.inf
    )
    return text.partition("\n")[0]
