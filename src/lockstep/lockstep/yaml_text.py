"""YAML as people write it in profiles, sweeps, schedules and --set: YAML 1.2.

Numbers are in decimal notation, and null, true and false in lower case; the rest is text.

PyYAML reads YAML 1.1, in which 1e-5 is a text, 010 is eight, `on` is true, 1:30 is 90 and the last
of two equal keys silently wins.
"""

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
