"""The parts of the pages that the code says: commands, settings, muscles, topics, public names.

launch_scripts/docs.sh calls this; pages of docs include what it writes.

usage: generated.py DIRECTORY
"""

import importlib
import os
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import get_type_hints

import numpy as np

from active_binocular_vision.command_lines.abv import COMMANDS
from experiment_manager.preparation.profile_paths import profile_files
from experiment_manager.sections import CONFIG_CLASSES, DEFAULTS, SHARED_CLASSES
from eye_plant import Episode
from eye_plant.mechanics.anatomical import ANATOMICAL
from eye_plant.mechanics.k17 import K17
from lockstep.settings import declarations
from lockstep.wire import topics
from lockstep.written.yaml_text import load_yaml, yaml_line

PACKAGES = (
    *("active_binocular_vision", "experiment_manager", "eye_plant", "sparse_coder", "vergence_rl"),
    "lockstep",
)


def write_all(directory: Path) -> None:
    """Write a page of each kind into a directory."""
    directory.mkdir(parents=True, exist_ok=True)
    for kind in (_commands, _parameters, _profiles, _muscles, _topics, _episode, _api):
        (directory / f"{kind.__name__[1:]}.md").write_text("\n".join(kind()) + "\n")


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
        yield from (f"## {section}", "")
        yield from _table(
            ("name", "meaning", "allowed", "default"),
            (
                (f"`{d.name}`", d.setting.description, d.setting.expected, f"`{default}`")
                for d in rows
                for default in (yaml_line(DEFAULTS[section][d.name]),)
            ),
        )


def _profiles() -> Iterator[str]:
    for name, path in sorted(profile_files().items(), key=lambda item: ("/" in item[0], item[0])):
        profile = load_yaml(path.read_text())
        base = f" Based on `{profile['base']}`." if "base" in profile else ""
        yield from (f"**`{name}`** {profile['description']}{base}", "", "```text")
        for section, settings in profile["settings"].items():
            yield from (f"{section}.{key}={yaml_line(value)}" for key, value in settings.items())
        for change in profile.get("schedule", ()):
            yield f"from {change['at']} on: {yaml_line(change['set'])}"
        yield from ("```", "")


_MUSCLE_HEAD = (
    *("muscle", "origin, mm", "pulley, mm", "insertion, mm", "F0, N", "l0, mm", "slack, mm"),
    *("v_max, l0/s", "mass, g", "l_min", "l_max", "s", "tonic activation"),
)


def _muscles() -> Iterator[str]:
    for name, parameter_set in (("anatomical", ANATOMICAL), ("k17", K17)):
        yield from (f"**Muscles of `{name}`.**", "")
        rows = []
        for muscle, m in parameter_set.muscles.items():
            points = [
                " ".join(f"{1e3 * x:.4g}" for x in point)
                for point in (m.origin_m, m.pulley_m, m.insertion_m)
            ]
            lengths_mm = 1e3 * np.array([m.optimal_length_m, m.slack_length_m])
            numbers = (m.peak_force_n, *lengths_mm, m.max_velocity_per_s, 1e3 * m.mass_kg)
            shape = (m.shortest, m.longest, m.passive_stiffness, m.tonic_activation)
            cells = (f"{x:.4g}" for x in (*numbers, *shape))
            rows.append((muscle.replace("_", " "), *points, *cells))
        yield from _table(_MUSCLE_HEAD, rows)


def _topics() -> Iterator[str]:
    senders = {
        "eye_plant": (*topics.PICTURES, *topics.CAMERA_INFOS, *topics.PLANT_VECTORS, "/clock"),
        "sparse_coder": ("features", *topics.CODER_VECTORS, topics.GAZE),
        "vergence_rl": (*topics.LEARNER_VECTORS, topics.JOINT_COMMAND),
        "experiment_manager": (topics.PARAMETER_CHANGES,),
        "robot's head": (topics.JOINT_STATES,),
        "every node": ("/diagnostics",),
    }
    of = {topic: sender for sender, sent in senders.items() for topic in sent}
    rows = ((f"`{topic}`", kind, of[topic]) for topic, kind in topics.TOPIC_TYPES.items())
    return _table(("topic", "type", "from"), rows)


def _episode() -> Iterator[str]:
    words = {int: "integer", float: "double", tuple[float, ...]: "double array"}
    kinds = get_type_hints(Episode)
    rows = (
        (f"`{d.name}`", words[kinds[d.name]], d.setting.description, d.setting.expected)
        for d in declarations(Episode)
    )
    return _table(("argument", "type", "meaning", "allowed"), rows)


def _table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    yield f"| {' | '.join(head)} |"
    yield "|" + "---|" * len(head)
    for cells in rows:
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
