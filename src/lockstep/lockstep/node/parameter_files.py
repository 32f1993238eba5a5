"""Parameters as a node is told them: on its command line, and in files that people write."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

from lockstep.errors import InputError
from lockstep.written.yaml_text import load_yaml, yaml_line


def parameter_arguments(values: Mapping[str, object]) -> list[str]:
    """Return the command-line arguments, behind --ros-args, that set parameters of a node.

    Raises InputError for a text that ROS cannot be told, which has to be in UTF-8.
    """
    return [
        word for name, value in values.items() for word in ("-p", f"{name}:={yaml_line(value)}")
    ]


def check_arguments(words: Sequence[str]) -> None:
    """Raise InputError for words of a command line that ROS cannot have or would misread.

    Words have to be in UTF-8. Of two equal names in a file of --params-file ROS takes the last,
    and reads 010 as eight. What is wrong besides is for ROS to refuse.
    """
    for word in words:
        try:
            word.encode()
        except UnicodeEncodeError as error:
            raise InputError(f"expected arguments in UTF-8, got {word!r}") from error
    for option, word in pairwise(words):
        if option == "--params-file" and Path(word).is_file():
            _check(Path(word))


def _check(path: Path) -> None:
    try:
        document = load_yaml(path.read_text(encoding="utf-8"))
        sections = document.items() if isinstance(document, dict) else ()
        for section, inside in sections:
            names = list(_names(inside))
            if twice := [name for name in names if names.count(name) > 1]:
                raise InputError(f"{section}: expected each name once, got {twice[0]!r} twice")
    except (InputError, ValueError) as error:
        raise InputError(f"{path}: {error}") from error


def _names(values: Any, prefix: str = "") -> Iterator[str]:
    """Yield the names of parameters, a.b for {a: {b: value}}."""
    if not isinstance(values, Mapping):
        yield prefix.removesuffix(".")
        return
    for name, value in values.items():
        yield from _names(value, f"{prefix}{name}.")
