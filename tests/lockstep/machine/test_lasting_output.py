"""Output that nobody takes any more."""

import os
import subprocess
import sys

from lockstep.machine.lasting_output import lasting
from tests.patience import PATIENCE_S


def test_a_reader_that_leaves_is_not_missed() -> None:
    theirs, ours = os.pipe()
    stream = lasting(os.fdopen(ours, "w"))
    print("hello", file=stream, flush=True)
    assert os.read(theirs, 10) == b"hello\n"
    os.close(theirs)
    for _ in range(3):
        print("is anybody there", file=stream, flush=True)
    assert not stream.isatty()
    stream.close()


def test_streams_that_were_closed_from_the_start_go_nowhere() -> None:
    code = (
        "import sys;"
        "from lockstep.machine.lasting_output import ignore_broken_pipes;"
        "ignore_broken_pipes(); print('lost'); print('lost', file=sys.stderr, flush=True);"
        "sys.exit(sys.stderr.fileno() + 40)"
    )
    done = subprocess.run(
        ["sh", "-c", 'exec "$0" -c "$1" <&- >&- 2>&-', sys.executable, code],
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 42
