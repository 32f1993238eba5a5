"""Write the eyes of both parameter sets as MJCF: python -m eye_plant.export --out DIR."""

import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from lockstep import InputError, build
from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.files.durable_files import is_free
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path
from lockstep.written.yaml_text import load_yaml

_PREFIX = "eyes.mechanics."


def export(directory: Path, settings: Mapping[str, Any] | None = None) -> None:
    """Write the MJCF files and their README.

    settings: of palsies and surgery, {NAME: value} as of eyes.mechanics. Raises InputError for
    others, and unless the directory is new or empty.
    """
    if not is_free(directory):
        raise InputError(f"expected a new or empty directory, got {directory}")
    # Not at the top: a help need not wait for MuJoCo.
    from eye_plant.export.mjcf import mjcf  # noqa: PLC0415
    from eye_plant.mechanics.mujoco_model import PARAMETER_SETS, MechanicsConfig  # noqa: PLC0415

    eyes = [
        build(MechanicsConfig, {**(settings or {}), "parameter_set": name})
        for name in PARAMETER_SETS
    ]
    directory.mkdir(parents=True, exist_ok=True)
    for config in eyes:
        (directory / f"eyes_{config.parameter_set}.xml").write_text(mjcf(config))
    shutil.copy(Path(__file__).with_name("README.md"), directory)


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return its exit code."""
    parser = CommandLine(
        prog=command("export-model"),
        description="Write the eyes as MJCF, with a README of their own.",
    )
    parser.add_argument(
        "--out",
        type=written_path,
        default=Path("eyes"),
        metavar="DIR",
        help="new or empty directory (default: eyes)",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar=f"{_PREFIX}NAME=VALUE",
        help="a palsy or surgery, as of abv run; may be repeated",
    )
    options = parser.parse_args(arguments)
    directory: Path = options.out
    try:
        export(directory, dict(map(_read_setting, options.set)))
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    print(f"wrote {', '.join(str(file) for file in sorted(directory.iterdir()))}")
    return 0


def _read_setting(text: str) -> tuple[str, Any]:
    key, equals, value = text.partition("=")
    if not (equals and key.startswith(_PREFIX)):
        raise InputError(f"--set: expected {_PREFIX}NAME=VALUE, got {text!r}")
    return key.removeprefix(_PREFIX), load_yaml(value)


if __name__ == "__main__":
    sys.exit(main())
