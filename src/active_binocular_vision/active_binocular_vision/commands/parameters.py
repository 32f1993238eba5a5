"""Lists the parameters of nodes with meaning, unit, bounds and defaults, as a parameter file."""

import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

from active_binocular_vision.command_lines.parameters import parser
from experiment_manager.nodes import NODES
from experiment_manager.run.config_file import EVERY_NODE
from experiment_manager.sections import CONFIG_CLASSES, DEFAULTS, SHARED_CLASSES
from lockstep.settings import Declaration, Setting, declarations
from lockstep.written.yaml_text import yaml_line

_WIDTH = 100
_COMMENT = "    # "


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code."""
    print(parameter_file(parser().parse_args(arguments).nodes or NODES), end="")
    return 0


def parameter_file(nodes: Sequence[str]) -> str:
    """Return the text of a parameter file of nodes: each parameter explained, at its default.

    What several nodes read, the task and the eyes, stands once, for every node.
    """
    declared = {node: declarations(CONFIG_CLASSES[node]) for node in nodes}
    known = {d.name for of_node in declared.values() for d in of_node}
    lines = ["# The task and the eyes, as every node reads them.", f"{EVERY_NODE}:"]
    lines.append("  ros__parameters:")
    for section, kind in SHARED_CLASSES.items():
        for d in declarations(kind):
            if d.name in known:
                lines += _explained(d, DEFAULTS[section])
    for node, of_node in declared.items():
        lines += [f"/**/{node}:", "  ros__parameters:"]
        for d in of_node:
            if d.name in DEFAULTS[node]:
                lines += _explained(d, DEFAULTS[node])
    return "\n".join(lines) + "\n"


def _explained(declared: Declaration, defaults: Mapping[str, Any]) -> list[str]:
    comment = textwrap.wrap(
        _comment(declared.setting), _WIDTH, initial_indent=_COMMENT, subsequent_indent=_COMMENT
    )
    return [*comment, f"    {declared.name}: {yaml_line(defaults[declared.name])}"]


def _comment(setting: Setting) -> str:
    if not setting.expected:
        return setting.description
    says_unit = f" {setting.unit}" in setting.expected
    return f"{setting.text if says_unit else setting.description} ({setting.expected})"
