"""The list of parameters says what each one means, and is a parameter file of the defaults."""

import pytest
import yaml

from active_binocular_vision.commands.parameters import main, parameter_file
from experiment_manager.sections import CONFIG_CLASSES
from lockstep import flatten


@pytest.mark.parametrize("node", CONFIG_CLASSES)
def test_a_parameter_file_holds_the_defaults(node: str) -> None:
    sections = yaml.safe_load(parameter_file([node]))
    assert list(sections) == ["/**/*", f"/**/{node}"]
    values = [section["ros__parameters"] or {} for section in sections.values()]
    assert not values[0].keys() & values[1].keys()
    assert values[0] | values[1] == flatten(CONFIG_CLASSES[node]())


def test_each_parameter_is_explained(capsys: pytest.CaptureFixture[str]) -> None:
    assert main([]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert lines.count("    n_selections: 10") == 1, "what all nodes read stands once"
    at = lines.index("    n_selections: 10")
    assert lines[at - 1] == "    # matching pursuit's selections per patch (1 or more)"


def test_an_unknown_node_is_one_error(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["nose"])
    assert ended.value.code == 2
    assert "expected one of eye_plant, " in capsys.readouterr().err
