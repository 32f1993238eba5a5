"""Draws what muscles do at nine gaze positions from the examinations that are kept of a run.

usage: .venv/bin/python results/draw_nine_positions.py RESULTS RUN PNG
"""

import json
import sys
from pathlib import Path

import numpy as np

from active_binocular_vision.figures.examinations.nine_positions import learned_beside_least
from active_binocular_vision.figures.style import own_style, save
from active_binocular_vision.runs.results_folder import runs_at
from lockstep import MUSCLE_NAMES


def main() -> None:
    """Draw the learned activations beside those of the least energy."""
    results, name, png = Path(sys.argv[1]), sys.argv[2], Path(sys.argv[3])
    examined = json.loads((results / "examinations.json").read_text())[name]["examined"]
    (found,) = (e for e in examined if e["examination"] == "nine-positions")
    rows = found["positions"]
    distances_m = sorted({row["object_distance_m"] for row in rows})
    learned, least = (
        np.array([[row[kind][muscle] for muscle in MUSCLE_NAMES] for row in rows], float).reshape(
            len(distances_m), -1, len(MUSCLE_NAMES)
        )
        for kind in ("learned", "least")
    )
    (run,) = (run for run in runs_at(results) if run.name.endswith(name))
    with own_style():
        plant = run.evaluation_settings.plant
        save(learned_beside_least(distances_m, learned, least, plant, found["n_stimuli"]), png)


if __name__ == "__main__":
    main()
