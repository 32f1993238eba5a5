"""benchmark.sh: how fast the graph is, how fast the same loop in one process, and its stages."""

import json
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from lockstep.written.command_line import CommandLine
from lockstep.written.paths import written_path


def main(argv: Sequence[str] | None = None) -> int:
    """Measure, print the table, and write JSON if asked; return the exit code."""
    parser = CommandLine(
        prog="benchmark.sh", description="Measure the speed of the graph and of its stages."
    )
    parser.add_argument(
        "--quick", action="store_true", help="take a few minutes, with less exact numbers"
    )
    parser.add_argument(
        "--against",
        metavar="REV",
        help="only compare this commit with REV: short windows of both in turns, median ratios",
    )
    parser.add_argument(
        "--json", type=written_path, metavar="FILE", help="write all numbers to FILE"
    )
    options = parser.parse_args(argv)
    # Not at the top: a help need not wait for ROS.
    from tools.benchmark.against import against  # noqa: PLC0415
    from tools.benchmark.measuring import measure, report  # noqa: PLC0415

    with tempfile.TemporaryDirectory(prefix="benchmark-") as directory:
        try:
            if options.against is None:
                results = measure(2 if options.quick else 7, 5.0, Path(directory))
            else:
                turns = (
                    {"in_process": 6, "graph": 2}
                    if options.quick
                    else {"in_process": 20, "graph": 7}
                )
                results = against(options.against, turns, 5.0, Path(directory))
        except (AssertionError, RuntimeError, TimeoutError) as error:
            print(f"error: {error}", file=sys.stderr)
            return 1
    print(report(results))
    if options.json is not None:
        options.json.write_text(json.dumps(results, indent=2) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
