"""What processes that compile at once leave, as the nodes of a first start do, works together."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

from tests.patience import PATIENCE_S

CODE = """
from eye_plant.mechanics.metabolics import metabolic_terms
from eye_plant.mechanics.parameters import Energetics
terms = metabolic_terms(
    excitation=0.3, activation=0.2, length=1.1, velocity_per_s=-0.5, isometric_force=0.9,
    contractile_force_n=0.4, optimal_length_m=0.03, max_velocity_per_s=10.0, mass_kg=1e-3,
    energetics=Energetics(),
)
print(terms.total_w.hex())
"""


def _said(cache: Path, code: str) -> str:
    done = subprocess.run(
        [sys.executable, "-c", code],
        env=os.environ | {"NUMBA_CACHE_DIR": str(cache)},
        capture_output=True,
        text=True,
        check=False,
        timeout=PATIENCE_S,
    )
    assert done.returncode == 0, f"exit code {done.returncode}:\n{done.stderr}"
    return done.stdout


def test_each_function_in_the_cache_goes_with_others_compiled_later(tmp_path: Path) -> None:
    whole = tmp_path / "whole"
    said = _said(whole, CODE)
    functions = {path.name.split(".py")[0] for path in whole.rglob("*.nbi")}
    energetics = {
        name for name in functions if name.startswith(("compiled.", "metabolics.", "muscles."))
    }
    assert "metabolics._fill_terms_w" in {name.rpartition("-")[0] for name in energetics}
    for kept in energetics:
        compiled_later = [f"{name}.py*" for name in energetics - {kept}]
        cache = tmp_path / kept
        shutil.copytree(whole, cache, ignore=shutil.ignore_patterns(*compiled_later))
        # Numba numbers functions as it compiles them: these get other numbers than before.
        assert _said(cache, f"import eye_plant.mechanics.muscles\n{CODE}") == said
