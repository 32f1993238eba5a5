"""Each command line in the documentation names a script, options and files that exist."""

import argparse
import re
import shlex
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from active_binocular_vision.command_lines import (
    evaluate,
    inspect_bag,
    report,
    run_experiment,
    sweep,
)
from active_binocular_vision.commands.command_line import request_of
from active_binocular_vision.runs.results_folder import runs_at
from experiment_manager import configuration_of

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *(p for d in ("docs", "results") for p in (ROOT / d).rglob("*.md"))]
PARSERS: dict[str, Callable[[], argparse.ArgumentParser]] = {
    "run_experiment": run_experiment.parser,
    "evaluate": evaluate.parser,
    "report": report.parser,
    "inspect_bag": inspect_bag.parser,
    "sweep": sweep.parser,
}
_BLOCK = re.compile(r"^ *```\w*\n(.*?)^ *```$", re.MULTILINE | re.DOTALL)
_SPAN = re.compile(r"(?<!`)`(launch_scripts/[^`]+)`")


def _command_lines(page: Path) -> Iterator[list[str]]:
    """Yield the words of each call of a script: whole lines of blocks, and spans of code."""
    text = page.read_text().replace("\\\n", " ")
    lines = [line for block in _BLOCK.findall(text) for line in block.splitlines()]
    spans = [span.replace("\n", " ") for span in _SPAN.findall(_BLOCK.sub("", text))]
    for line in [*lines, *spans]:
        _, found, command = line.partition("launch_scripts/")
        if found and "..." not in command and "[" not in command:
            yield shlex.split(command, comments=True)


COMMANDS = [(page, words) for page in PAGES for words in _command_lines(page)]


@pytest.mark.parametrize(
    ("page", "words"), COMMANDS, ids=[f"{p.stem}: {' '.join(w)}" for p, w in COMMANDS]
)
def test_a_documented_command_can_be_read(page: Path, words: list[str]) -> None:
    script, *arguments = words
    assert (ROOT / "launch_scripts" / script).is_file()
    for word in arguments:
        is_of_ours = word.startswith(("sweeps/", "results/")) and "NAME" not in word
        assert not is_of_ours or (ROOT / word).exists() or runs_at(ROOT / word), word
    name = script.removesuffix(".sh")
    if name not in PARSERS or not arguments:
        return
    options = PARSERS[name]().parse_args(arguments)
    if name == "run_experiment" and not (options.resume or options.branch or options.stimuli):
        configuration_of(request_of(options), commit="")


def test_the_pages_have_commands_of_every_kind() -> None:
    assert {f"{name}.sh" for name in PARSERS} <= {words[0] for _, words in COMMANDS}
    assert {page.name for page, _ in COMMANDS} >= {"README.md", "running.md", "paper.md"}
