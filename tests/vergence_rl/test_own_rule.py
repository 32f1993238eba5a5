"""A rule of one's own, from a file or a module: it learns, and what is none is refused."""

import pickle
from pathlib import Path

import pytest

from lockstep import InputError, build, flatten
from tests.own_rule import EXAMPLE, REINFORCE
from tests.vergence_rl.probe import SETTINGS, gaze_errors, trained_on_gazes
from vergence_rl import Agent, VergenceRlConfig
from vergence_rl.rules import rule_of


def _config(rule: str, own: str = "") -> VergenceRlConfig:
    return build(VergenceRlConfig, SETTINGS | {"learning_rule": rule, "own_rule": own})


def test_it_learns_the_probe() -> None:
    agent = Agent(_config(REINFORCE))
    trained_on_gazes(agent, 1500)
    assert gaze_errors(agent)[0].max() < 0.005


def test_a_module_names_it_as_a_file_does(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(EXAMPLE.parent))
    config = _config("reinforce:ReinforceRule", '{"exploration_variance": 0.25}')
    assert type(config.rule_config).__module__ == "reinforce"
    assert flatten(config.rule_config)["exploration_variance"] == 0.25


@pytest.mark.parametrize(
    ("rule", "own", "message"),
    [
        ("cacl", "", r"FILE\.py:CLASS or MODULE:CLASS, got 'cacl'; did you mean cacla\?"),
        ("no_such_module:Rule", "", "can be imported, got 'no_such_module:Rule' .*No module named"),
        ("no_such_file.py:Rule", "", r"can be imported, got .*\(FileNotFoundError: .*No such file"),
        (f"{EXAMPLE}:Reinforce", "", r"\(AttributeError: .* has no attribute 'Reinforce'\)"),
        ("math:sqrt", "", "expected a class with settings, step, state, restore, got 'math:sqrt'"),
        (REINFORCE, "[1]", r"own_rule: expected {NAME: VALUE}, got '\[1\]'"),
        (REINFORCE, "{learning_rat: 1}", "own_rule: unknown parameter .*mean learning_rate"),
        (REINFORCE, "{learning_rate: -1}", "own_rule: learning_rate: expected 0 or more, got -1"),
        ("cacla", "{discount: 1}", "own_rule: expected none with cacla, got '{discount: 1}'"),
    ],
)
def test_what_is_no_rule_is_refused(rule: str, own: str, message: str) -> None:
    with pytest.raises(InputError, match=message):
        _config(rule, own)


def test_a_rule_can_be_pickled_after_another_name_was_asked_of_its_file() -> None:
    rule = rule_of(REINFORCE)
    with pytest.raises(InputError):
        rule_of(f"{EXAMPLE}:Reinforce")
    assert pickle.loads(pickle.dumps(rule)) is rule


def test_a_file_that_cannot_be_read_says_why(tmp_path: Path) -> None:
    (tmp_path / "mine.py").write_text("1 / 0")
    with pytest.raises(InputError, match=r"mine.py:Rule' \(ZeroDivisionError: division by zero\)"):
        _config(f"{tmp_path}/mine.py:Rule")
