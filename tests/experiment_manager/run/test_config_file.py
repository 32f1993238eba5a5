from pathlib import Path

import pytest

from experiment_manager.run.checkpoint import Manifest
from experiment_manager.run.config_file import (
    EVERY_NODE,
    check_unchanged,
    configuration_text,
    read_configuration,
)
from experiment_manager.run.progress import Progress
from experiment_manager.sections import DEFAULTS
from lockstep import InputError
from lockstep.written.yaml_text import dump_yaml, load_yaml
from tests.pair import PAIR_SPACE

GONE: dict[str, object] = {"scales.whitened": False}


def written(path: Path, shared: dict[str, object]) -> Path:
    document = load_yaml(configuration_text(DEFAULTS))
    document[EVERY_NODE]["ros__parameters"] |= shared
    path.write_text(dump_yaml(document))
    return path


def manifest(changed: dict[str, object]) -> Manifest:
    parameters = {"task": DEFAULTS["task"] | changed}
    return Manifest(1, parameters, (), {}, Progress(0, PAIR_SPACE).state())


def test_a_parameter_that_is_gone_is_left_out_where_it_changed_nothing(tmp_path: Path) -> None:
    found = read_configuration(written(tmp_path / "config.yaml", GONE))
    assert found == DEFAULTS
    check_unchanged(tmp_path, manifest(GONE), found)
    with pytest.raises(InputError, match=r"task\.seed was 9"):
        check_unchanged(tmp_path, manifest(GONE | {"seed": 9}), found)


def test_a_parameter_that_is_gone_is_refused_where_it_changed_something(tmp_path: Path) -> None:
    path = written(tmp_path / "config.yaml", {"scales.whitened": True})
    with pytest.raises(InputError, match=r"unknown parameter scales\.whitened"):
        read_configuration(path)
