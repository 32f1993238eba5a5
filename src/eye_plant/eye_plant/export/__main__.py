"""Write the eyes of both parameter sets as MJCF: python -m eye_plant.export --out DIR."""

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT
from lockstep.files.durable_files import is_free
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path


def export(directory: Path) -> None:
    """Write the MJCF files and their README; raises InputError unless it is new or empty."""
    if not is_free(directory):
        raise InputError(f"expected a new or empty directory, got {directory}")
    # Not at the top: a help need not wait for MuJoCo.
    from eye_plant.export.mjcf import mjcf  # noqa: PLC0415
    from eye_plant.mechanics.mujoco_model import PARAMETER_SETS  # noqa: PLC0415

    directory.mkdir(parents=True, exist_ok=True)
    for name in PARAMETER_SETS:
        (directory / f"eyes_{name}.xml").write_text(mjcf(name))
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
    directory: Path = parser.parse_args(arguments).out
    try:
        export(directory)
    except (InputError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return EXIT_BAD_INPUT
    print(f"wrote {', '.join(str(file) for file in sorted(directory.iterdir()))}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
