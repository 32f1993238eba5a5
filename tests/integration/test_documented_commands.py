"""Each command line in the documentation names a script, options and files that exist."""

import argparse
import re
import shlex
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

import pytest

from active_binocular_vision.command_lines import (
    bag,
    baselines,
    evaluate,
    examine,
    report,
    run,
    sweep,
)
from active_binocular_vision.command_lines.abv import COMMANDS as ABV_COMMANDS
from active_binocular_vision.commands.command_line import request_of
from active_binocular_vision.runs.results_folder import runs_at
from experiment_manager import configuration_of

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *(p for d in ("docs", "results") for p in (ROOT / d).rglob("*.md"))]
PARSERS: dict[str, Callable[[], argparse.ArgumentParser]] = {
    "run": run.parser,
    "evaluate": evaluate.parser,
    "examine": examine.parser,
    "report": report.parser,
    "bag": bag.parser,
    "baselines": baselines.parser,
    "sweep": sweep.parser,
}
_BLOCK = re.compile(r"^ *```\w*\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)
_SPAN = re.compile(r"(?<!`)`((?:launch_scripts/|abv )[^`]+)`")
_CALL = re.compile(r"launch_scripts/(\S+\.sh)|(?:^|bin/| )abv(?= )")
_STARTS = re.compile(r'^abv ([\w-]+) "\$@"$', re.MULTILINE)  # the command that a script is


def _command_lines(page: Path) -> Iterator[list[str]]:
    """Yield the words of each call of a script, or of abv: whole lines of blocks, and spans."""
    text = page.read_text().replace("\\\n", " ")
    lines = [line for block in _BLOCK.findall(text) for line in block.splitlines()]
    spans = [span.replace("\n", " ") for span in _SPAN.findall(_BLOCK.sub("", text))]
    for line in [*lines, *spans]:
        code = line.partition("#")[0]
        call = _CALL.search(code)
        if call and "..." not in code and "[" not in code:
            yield [call[1] or "abv.sh", *shlex.split(line[call.end() :], comments=True)]


COMMANDS = [(page, words) for page in PAGES for words in _command_lines(page)]


@pytest.mark.parametrize(
    ("page", "words"), COMMANDS, ids=[f"{p.stem}: {' '.join(w)}" for p, w in COMMANDS]
)
def test_a_documented_command_can_be_read(page: Path, words: list[str]) -> None:
    name, arguments = _command(*words)
    for word in arguments:
        is_of_ours = word.startswith(("sweeps/", "results/")) and "NAME" not in word
        assert not is_of_ours or (ROOT / word).exists() or runs_at(ROOT / word), word
    if name not in PARSERS or not arguments:
        return
    options = PARSERS[name]().parse_args(arguments)
    if name == "run" and not (options.resume or options.branch or options.stimuli):
        configuration_of(request_of(options), commit="")


def _command(script: str, *arguments: str) -> tuple[str, Sequence[str]]:
    """Return the command of abv that a script starts, "" where it starts none, and its words."""
    path = ROOT / "launch_scripts" / script
    if script == "abv.sh":
        name, *rest = arguments
        assert name in {"COMMAND", "--help", "--version", *ABV_COMMANDS}
        return name, rest
    return next(iter(_STARTS.findall(path.read_text())), ""), arguments


def test_the_pages_have_commands_of_every_kind() -> None:
    assert PARSERS.keys() <= {_command(*words)[0] for _, words in COMMANDS}
    assert {page.name for page, _ in COMMANDS} >= {"README.md", "sweep.md", "paper.md"}
