"""The parameter files of the nodes say what each parameter means, and agree with the defaults."""

from pathlib import Path

import pytest
import yaml

from active_binocular_vision.commands.list_parameters import main, parameter_file
from experiment_manager.run.config_file import CONFIG_CLASSES
from lockstep.configuration import flatten

ROOT = Path(__file__).parents[3]


@pytest.mark.parametrize("node", CONFIG_CLASSES)
def test_the_parameter_file_of_a_package_is_what_its_settings_say(node: str) -> None:
    path = ROOT / f"src/{node}/config/{node}.yaml"
    command = f"launch_scripts/list_parameters.sh {node} > {path.relative_to(ROOT)}"
    assert path.read_text() == parameter_file(node), f"to make it again: {command}"


@pytest.mark.parametrize("node", CONFIG_CLASSES)
def test_a_parameter_file_holds_the_defaults(node: str) -> None:
    read = yaml.safe_load(parameter_file(node))
    assert read == {f"/**/{node}": {"ros__parameters": flatten(CONFIG_CLASSES[node]())}}


def test_each_parameter_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sparse_coder"]) == 0
    lines = capsys.readouterr().out.splitlines()
    at = lines.index("    n_selections: 10")
    assert lines[at - 1] == "    # matching pursuit's selections per patch (1 or more)"


def test_an_unknown_node_is_one_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["nose"])
    assert ended.value.code == 2
    assert "expected a node of eye_plant, " in capsys.readouterr().err
