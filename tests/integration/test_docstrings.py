"""The examples in the docstrings of classes that people use."""

import doctest
import importlib

import pytest

MODULES = (
    "eye_plant.plant",
    "sparse_coder.coder",
    "vergence_rl.agent",
    "experiment_manager.loop",
)


@pytest.mark.parametrize("module", MODULES)
def test_examples_give_what_they_say(module: str) -> None:
    result = doctest.testmod(importlib.import_module(module))
    assert result.attempted
    assert not result.failed
