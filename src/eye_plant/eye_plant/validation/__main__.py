"""Hold both sets of eyes against physiology and OpenEyeSim: python -m eye_plant.validation.

Writes plant_validation.json, a list of {name, value, unit, bound, ok}, and one page of figures.
"""

import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path

from eye_plant.mechanics.model import PARAMETER_SETS
from eye_plant.validation.dynamic_checks import (
    disparity_row,
    energy_row,
    saccade_rows,
    saccades,
    step_time_row,
)
from eye_plant.validation.openeyesim import MAPS_VARIABLE, Maps, load_maps
from eye_plant.validation.page import draw_page
from eye_plant.validation.row import Row
from eye_plant.validation.static_checks import anatomical_tension_rows, k17_rows, shared_rows
from lockstep.command_line import CommandLine
from lockstep.errors import InputError

JSON_NAME = "plant_validation.json"
PAGE_NAME = "plant_validation.png"


def measure(maps: Maps | None) -> Iterator[Row]:
    """Every row of the validation, one after another; maps: of OpenEyeSim, if there."""
    for parameter_set in PARAMETER_SETS:
        yield step_time_row(parameter_set)
    yield from k17_rows(maps)
    for parameter_set in PARAMETER_SETS:
        yield from shared_rows(parameter_set)
        yield energy_row(parameter_set)
        yield disparity_row(parameter_set)
    yield from anatomical_tension_rows()
    yield from saccade_rows(saccades())


def main(arguments: Sequence[str] | None = None) -> int:
    """Measure, print, write; return 1 when a bound fails."""
    parser = CommandLine(
        prog="validate_plant.sh",
        description="Compare the simulated eyes with physiology.",
        epilog=f"{MAPS_VARIABLE} may name OpenEyeSim's maps; the rows that need them are "
        "reported as not measured otherwise.",
    )
    parser.add_argument("--out", type=Path, default=Path("plant_validation"), help="directory")
    out: Path = parser.parse_args(arguments).out
    try:
        out.mkdir(parents=True, exist_ok=True)
        maps = load_maps()
    except OSError as error:
        parser.error(f"--out: expected a directory to write to, got {out} ({error})")
    except InputError as error:
        parser.error(str(error))
    rows = []
    for row in measure(maps):
        rows.append(row)
        verdict = {True: "ok", False: "FAILS", None: "not measured"}[row.ok]
        value = f"{row.value:.4g} {row.unit}" if row.ok is not None else "-"
        print(f"{verdict:>12}  {row.name}: {value} ({row.bound})", flush=True)
    (out / JSON_NAME).write_text(json.dumps([row.as_dict() for row in rows], indent=1) + "\n")
    draw_page(out / PAGE_NAME, maps)
    print(f"wrote {out / JSON_NAME} and {out / PAGE_NAME}")
    return int(any(row.ok is False for row in rows))


if __name__ == "__main__":
    sys.exit(main())
