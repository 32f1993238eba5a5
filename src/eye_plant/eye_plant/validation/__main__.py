"""Hold both sets of eyes against physiology and OpenEyeSim: python -m eye_plant.validation."""

import json
import os
import sys
from collections.abc import Sequence
from pathlib import Path

from eye_plant.validation import MAPS_VARIABLE
from lockstep.written.command_line import CommandLine, command
from lockstep.written.paths import written_path

JSON_NAME = "plant_validation.json"
FIGURE_NAME = "plant_validation.png"
_VERDICTS = {True: "ok", False: "FAILS", None: "not measured"}


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, write; return 1 when a bound fails."""
    parser = CommandLine(
        prog=command("validate-plant"),
        description="Compare the simulated eyes with physiology.",
        epilog=f"{MAPS_VARIABLE} may name OpenEyeSim's maps; the rows that need them are "
        "reported as not measured otherwise.",
    )
    parser.add_argument(
        "--out",
        type=written_path,
        default=Path("plant_validation"),
        metavar="DIR",
        help="where to write the values and a figure (default: plant_validation)",
    )
    out: Path = parser.parse_args(arguments).out
    # The figure is a file. A notebook's kernel names a backend that matplotlib may not find here.
    os.environ["MPLBACKEND"] = "agg"
    # Not at the top: a help need not wait for MuJoCo and Matplotlib.
    from eye_plant.validation.checks import CHECKS, openeyesim_maps  # noqa: PLC0415
    from eye_plant.validation.figure import draw  # noqa: PLC0415

    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        parser.error(f"--out: expected a directory to write to, got {out} ({error})")
    try:
        openeyesim_maps()
    except (OSError, ValueError) as error:
        parser.error(f"{MAPS_VARIABLE}: expected a file of 121 rows of 4 numbers: {error}")
    rows = []
    for check in CHECKS:
        row = check.row()
        rows.append(row)
        value = "-" if row["value"] is None else f"{row['value']:.4g} {row['unit']}".strip()
        verdict = f"{_VERDICTS[row['ok']]:>12}"
        print(f"{verdict}  {check.name}: {value} ({row['bound']}; {check.source})", flush=True)
    (out / JSON_NAME).write_text(json.dumps(rows, indent=1) + "\n")
    draw(out / FIGURE_NAME)
    print(f"wrote {out / JSON_NAME} and {out / FIGURE_NAME}")
    return int(any(row["ok"] is False for row in rows))


if __name__ == "__main__":
    sys.exit(main())
