"""A third rule is two files and one line, as `vergence_rl.learning_rule` says.

tests/vergence_rl/reinforce has the two files. Here the line is added to a copy of the table, which
comes before ours on the path of another process.
"""

import os
import subprocess
import sys
from pathlib import Path

import vergence_rl
import vergence_rl.rules
from tests.patience import PATIENCE_S

ROOT = Path(__file__).parents[2]
IMPORTS = """
from tests.vergence_rl.reinforce.config import ReinforceConfig
from tests.vergence_rl.reinforce.rule import ReinforceRule
"""
LINE = (
    "    reinforce: ReinforceConfig = field("
    'default_factory=ReinforceConfig, metadata={"rule": ReinforceRule})\n'
)


def _with_a_third_rule(directory: Path) -> None:
    """Make a package vergence_rl whose table has one line more; all else of it is ours."""
    package = Path(vergence_rl.__file__).parent
    copy = directory / "vergence_rl"
    copy.mkdir()
    ours = (package / "__init__.py").read_text()
    (copy / "__init__.py").write_text(f"__path__.append({str(package)!r})\n{ours}")
    head, table, rest = Path(vergence_rl.rules.__file__).read_text().partition("\n\nRULES")
    first, dataclass, entries = head.partition("\n\n@dataclass")
    (copy / "rules.py").write_text(f"{first}{IMPORTS}{dataclass}{entries}{LINE}{table}{rest}")


def test_it_can_be_chosen_and_learns_the_probe(tmp_path: Path) -> None:
    _with_a_third_rule(tmp_path)
    line = [sys.executable, "-m", "tests.vergence_rl.probe_of_third_rule", "reinforce"]
    path = os.pathsep.join([str(tmp_path), str(ROOT)])
    done = subprocess.run(
        line,
        check=False,
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) < 0.005
