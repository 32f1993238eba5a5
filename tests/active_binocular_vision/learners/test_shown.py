from pathlib import Path

import numpy as np

from active_binocular_vision.learners.shown import Shown
from eye_plant import load_stimuli
from eye_plant.stimuli.stimulus_set import StimuliConfig


def test_of_generated_stimuli_only_those_that_are_shown_are_made(tmp_path: Path) -> None:
    config = StimuliConfig(n_training=3, n_test=4, size_px=64, cache_directory=str(tmp_path))
    shown = Shown(n_most=2).load(config, 1)
    assert len(list(tmp_path.rglob("test_*.npy"))) == 2
    np.testing.assert_array_equal(shown.test, load_stimuli(config).test[:2])
    assert len(Shown(n_most=9).load(config, 1).test) == 4
