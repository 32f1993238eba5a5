"""Lists a node's parameters with their meaning, unit, bounds and defaults, as a parameter file."""

import math
import sys
import textwrap
from collections.abc import Sequence

import yaml

from experiment_manager.run.config_file import CONFIG_CLASSES
from lockstep.command_line import CommandLine
from lockstep.configuration import flatten
from lockstep.settings import Setting, declarations

_WIDTH = 100
_COMMENT = "    # "


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code."""
    parser = CommandLine(
        prog="list_parameters.sh",
        description="Print the parameters of nodes and their defaults, as a ROS parameter file.",
    )
    parser.add_argument(
        "nodes", nargs="*", metavar="NODE", help=f"some of {', '.join(CONFIG_CLASSES)}; default all"
    )
    nodes = parser.parse_args(arguments).nodes or list(CONFIG_CLASSES)
    for node in nodes:
        if node not in CONFIG_CLASSES:
            parser.error(f"expected a node of {', '.join(CONFIG_CLASSES)}, got {node!r}")
    print("\n".join(parameter_file(node) for node in nodes), end="")
    return 0


def parameter_file(node: str) -> str:
    """Return the text of a node's parameter file: each parameter explained, at its default."""
    config_class = CONFIG_CLASSES[node]
    defaults = flatten(config_class())
    lines = [
        f"# Parameters of the node {node}, at their defaults.",
        f"/**/{node}:",
        "  ros__parameters:",
    ]
    for declared in declarations(config_class):
        value = yaml.safe_dump(
            defaults[declared.name], default_flow_style=True, width=math.inf
        ).partition("\n")[0]
        lines += textwrap.wrap(
            _comment(declared.setting), _WIDTH, initial_indent=_COMMENT, subsequent_indent=_COMMENT
        )
        lines.append(f"    {declared.name}: {value}")
    return "\n".join(lines) + "\n"


def _comment(setting: Setting) -> str:
    if not setting.expected:
        return setting.description
    says_unit = f" {setting.unit}" in setting.expected
    return f"{setting.text if says_unit else setting.description} ({setting.expected})"


if __name__ == "__main__":
    sys.exit(main())
