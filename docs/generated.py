"""The parts of the reference that the code says: commands, parameters and public names.

launch_scripts/docs.sh calls this; the pages of docs/reference include what it writes.

usage: generated.py DIRECTORY
"""

import importlib
import os
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from active_binocular_vision.command_lines.abv import COMMANDS
from experiment_manager.sections import CONFIG_CLASSES, DEFAULTS, SHARED_CLASSES
from lockstep.settings import declarations
from lockstep.written.yaml_text import yaml_line

PACKAGES = (
    *("active_binocular_vision", "experiment_manager", "eye_plant", "sparse_coder", "vergence_rl"),
    "lockstep",
)


def write_all(directory: Path) -> None:
    """Write commands.md, parameters.md and api.md into a directory."""
    directory.mkdir(parents=True, exist_ok=True)
    for name, lines in (("commands", _commands()), ("parameters", _parameters()), ("api", _api())):
        (directory / f"{name}.md").write_text("\n".join(lines) + "\n")


def _commands() -> Iterator[str]:
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        for name, text in zip(COMMANDS, pool.map(_help, COMMANDS), strict=True):
            yield from (f"## {name}", "", "```text", text.strip(), "```", "")


def _help(name: str) -> str:
    line = [sys.executable, "-m", "active_binocular_vision", name, "--help"]
    variables = os.environ | {"COLUMNS": "92"}
    done = subprocess.run(line, env=variables, capture_output=True, text=True, check=True)
    return done.stdout


def _parameters() -> Iterator[str]:
    for section, kind in {**SHARED_CLASSES, **CONFIG_CLASSES}.items():
        rows = [d for d in declarations(kind) if d.name in DEFAULTS[section]]
        yield from (
            f"## {section}",
            "",
            "| name | meaning | allowed | default |",
            "|---|---|---|---|",
        )
        for d in rows:
            default = yaml_line(DEFAULTS[section][d.name])
            cells = (f"`{d.name}`", d.setting.description, d.setting.expected, f"`{default}`")
            yield f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in cells)} |"
        yield ""


def _api() -> Iterator[str]:
    for package in PACKAGES:
        module = importlib.import_module(package)
        yield from (f"## {package}", "", "```{eval-rst}", f".. automodule:: {package}", "")
        for name in module.__all__:
            named = getattr(module, name)
            if not getattr(named, "__module__", "").startswith(package):
                continue  # a constant, or a name of another package, below
            if isinstance(named, type):
                yield from (f".. autoclass:: {package}.{name}", "   :members:", "")
            else:
                yield from (f".. autofunction:: {package}.{name}", "")
        yield from ("```", "")


if __name__ == "__main__":
    write_all(Path(sys.argv[1]))
