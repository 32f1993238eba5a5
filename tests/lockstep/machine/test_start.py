import gc
import sys
from pathlib import Path

import pytest

from lockstep.machine import start
from tests.supervisor import finished, started

MODULE = """
import gc, sys

COLLECTS = gc.isenabled()

def main():
    collecting = COLLECTS, gc.isenabled(), gc.get_freeze_count() > 0
    print(sys.argv[1:], *collecting, sys.modules['coverage'])
    sys.exit(3)
"""


def test_a_module_is_imported_without_looking_for_garbage_and_becomes_the_process(
    tmp_path: Path,
) -> None:
    (tmp_path / "some.py").write_text(MODULE)
    line = [sys.executable, "-m", start.__name__, "some", "1", "--two"]
    said = finished(started(line, {"PYTHONPATH": str(tmp_path)}), code=3)
    assert said == "['1', '--two'] False True True None\n"


def test_where_an_import_fails_garbage_is_looked_for_again() -> None:
    with pytest.raises(ModuleNotFoundError):
        start.imported("nowhere")
    assert gc.isenabled()
