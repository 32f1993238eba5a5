"""torture.sh: disturb runs on purpose, and compare their numbers with those of undisturbed ones."""

import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from lockstep import InputError
from lockstep.written.command_line import CommandLine
from lockstep.written.paths import written_path


def main(argv: Sequence[str] | None = None) -> int:
    """Kill, send hostile input, print figures and problems; return 0 when all held."""
    line = CommandLine(
        prog="torture.sh",
        description="Disturb runs on purpose: kill and stop nodes and supervisors at random points,"
        " and send hostile input. The numbers are compared with those of undisturbed runs.",
    )
    line.add_argument("--kills", type=int, default=40, metavar="N", help="default 40")
    line.add_argument("--inputs", type=int, default=30_000, metavar="N", help="default 30,000")
    line.add_argument("--seed", type=int, default=1, metavar="S", help="of all random draws")
    line.add_argument("--out", type=written_path, metavar="DIR", help="keep the runs in DIR")
    line.add_argument("--json", type=written_path, metavar="FILE", help="write the figures to FILE")
    options = line.parse_args(argv)
    # Not at the top: a help need not wait for ROS.
    from tools.stress.hostile_input import fuzz  # noqa: PLC0415
    from tools.stress.kills import kill  # noqa: PLC0415

    figures: dict[str, Any] = {"seed": options.seed}
    problems: list[str] = []
    with tempfile.TemporaryDirectory(prefix="torture_") as temporary:
        for name, work, n in (("kills", kill, options.kills), ("inputs", fuzz, options.inputs)):
            directory = Path(options.out or temporary).resolve() / name
            if n <= 0:
                continue
            directory.mkdir(parents=True)
            try:
                figures[name], found = work(directory, n, options.seed)
            # A part that cannot go on does not keep the other from its work.
            except (AssertionError, InputError, OSError, RuntimeError) as error:
                found = [f"{type(error).__name__}: {error}"]
            problems += [f"{name}: {problem}" for problem in found]
    text = json.dumps(figures | {"problems": problems}, indent=2)
    print(text)
    if options.json is not None:
        options.json.write_text(text + "\n")
    return int(bool(problems))


if __name__ == "__main__":
    sys.exit(main())
