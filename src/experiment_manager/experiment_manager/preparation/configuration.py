"""From the command line of run_experiment.sh to the effective configuration of all nodes."""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from experiment_manager.experiment.agreements import check_agreements, with_partners
from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.reach import check_reach
from experiment_manager.preparation.command_line import DEFAULT_METABOLIC_COST_WEIGHTS
from experiment_manager.preparation.profiles import read_profile
from experiment_manager.run.config_file import CONFIG_CLASSES, Configuration
from eye_plant.config import EyePlantConfig
from eye_plant.stimuli.stimulus_set import count_stimuli
from lockstep.configuration import build, flatten
from lockstep.errors import InputError
from lockstep.nearest import did_you_mean

_ITERATIONS = "experiment_manager.protocol.n_training_iterations"
_TESTS = "experiment_manager.protocol.test_iterations"
_TEST_STIMULI = "experiment_manager.protocol.n_stimuli_per_test"
_WEIGHT = "sparse_coder.metabolic_cost_weight"
_MODEL = "experiment_manager.model"
_SCHEDULE = "experiment_manager.schedule"
_SEEDS = ("sparse_coder.seed", "vergence_rl.seed", "experiment_manager.seed")


@dataclass(frozen=True)
class Given:
    """A value that somebody has given to a parameter, and the words that did so."""

    value: Any
    by: str


def configuration_of(options: argparse.Namespace, commit: str) -> Configuration:
    """Return all parameters of all nodes of a new run, by node, checked.

    Raises InputError for whatever a node would refuse.
    """
    is_paper = options.model is not None or options.iterations is not None
    profile = read_profile(options.profile or ("paper" if is_paper else "demonstration"))
    settings = {
        f"{node}.{name}": value
        for node, values in profile.settings.items()
        for name, value in values.items()
    }
    settings |= {
        "experiment_manager.profile": profile.name,
        "experiment_manager.commit": commit,
        _SCHEDULE: profile.schedule.text(),
    }
    return changed(settings, given_settings(options))


def given_settings(options: argparse.Namespace) -> dict[str, Given]:
    """Return what a command line says of single parameters, by NODE.PARAMETER.

    Raises InputError where it says two things of one parameter, or none that can be.
    """
    _check_share(options)
    given: dict[str, Given] = {}
    for place, setting in _settings(options):
        before = given.setdefault(place, setting)
        if before is not setting and before.value != setting.value:
            raise InputError(f"{before.by} and {setting.by}: expected one value of {place}")
    return given


def _settings(options: argparse.Namespace) -> Iterator[tuple[str, Given]]:
    if options.model is not None:
        yield _MODEL, Given(options.model, f"--model {options.model}")
    if options.iterations is not None:
        yield _ITERATIONS, Given(options.iterations, f"--iterations {options.iterations}")
    if options.seed is not None:
        for place in _SEEDS:
            yield place, Given(options.seed, f"--seed {options.seed}")
    if options.weight is not None:
        yield _WEIGHT, Given(options.weight, f"--lambda {options.weight:g}")
    if options.tests is not None:
        yield _TESTS, Given(options.tests, f"--tests {','.join(map(str, options.tests))}")
    if options.test_stimuli is not None:
        yield _TEST_STIMULI, Given(options.test_stimuli, f"--test-stimuli {options.test_stimuli}")
    if options.stimuli is not None:
        directory = str(options.stimuli.resolve())
        yield "eye_plant.stimuli.directory", Given(directory, f"--stimuli {options.stimuli}")
    for text in options.set:
        place, value = _read_setting(text)
        yield place, Given(value, f"--set {text}")


def plant_settings(texts: Sequence[str]) -> dict[str, Any]:
    """Return what eye_plant.PARAMETER=VALUE say, by the plant's dotted names.

    Raises InputError for other nodes, and for a parameter said twice.
    """
    settings: dict[str, Any] = {}
    for text in texts:
        place, value = _read_setting(text)
        node, _, name = place.partition(".")
        if node != "eye_plant" or name in settings:
            raise InputError(
                f"--set: expected each eye_plant.PARAMETER=VALUE of this test once, got {text!r}"
            )
        settings[name] = value
    return settings


def changed(settings: Mapping[str, Any], given: Mapping[str, Given]) -> Configuration:
    """Return all parameters of all nodes: settings by place, and above them what was given.

    Each brings those with it that must agree. Raises InputError for whatever a node would refuse,
    and for what contradicts itself.
    """
    above = with_partners({place: setting.value for place, setting in given.items()})
    values = with_partners(settings) | above
    _count_stimuli(values, given)
    if _WEIGHT not in above and (_MODEL in above or _WEIGHT not in values):
        values |= with_partners({_WEIGHT: _default_weight(values)})
    _check_tests(values, given)
    by_node: dict[str, dict[str, Any]] = {node: {} for node in CONFIG_CLASSES}
    for place, value in values.items():
        node, _, name = place.partition(".")
        by_node[node][name] = value
    configuration = {
        node: flatten(_built(node, settings_of_node)) for node, settings_of_node in by_node.items()
    }
    check_agreements(configuration)
    _check_price(configuration)
    check_reach(configuration)
    return configuration


def _check_share(options: argparse.Namespace) -> None:
    share = options.share
    if share is None:
        return
    if options.weight is not None:
        raise InputError("--lambda-share: expected it without --lambda, got both")
    if not 0.0 <= share < 1.0:
        raise InputError(f"--lambda-share: expected a share in [0, 1), got {share}")
    if options.model != "M_C":
        raise InputError(
            f"--lambda-share {share:g}: expected --model M_C, M has no price on energy"
        )


def _default_weight(values: Mapping[str, Any]) -> float:
    if values.get(_MODEL, "M") == "M":
        return 0.0
    default = EyePlantConfig().mechanics.parameter_set
    return DEFAULT_METABOLIC_COST_WEIGHTS[values.get("eye_plant.mechanics.parameter_set", default)]


def _check_price(configuration: Configuration) -> None:
    manager = configuration["experiment_manager"]
    weight = manager["metabolic_cost_weight"]
    if manager["model"] == "M" and weight > 0.0:
        raise InputError(
            f"metabolic_cost_weight (--lambda): expected 0 with model M, which has no price on "
            f"energy, got {weight:g}; --model M_C has one"
        )


def _count_stimuli(values: dict[str, Any], given: Mapping[str, Given]) -> None:
    """Set how many stimuli there are, and that a test has no more than that."""
    plant = _built(
        "eye_plant",
        {
            place.removeprefix("eye_plant."): value
            for place, value in values.items()
            if place.startswith("eye_plant.")
        },
    )
    n_training, n_test = count_stimuli(plant.stimuli)
    found = {"n_training_stimuli": n_training, "n_test_stimuli": n_test}
    for name, n_stimuli in found.items():
        place = f"experiment_manager.protocol.{name}"
        if place in given and given[place].value != n_stimuli:
            raise InputError(f"{given[place].by}: expected {n_stimuli}, as eye_plant.stimuli has")
        values[place] = n_stimuli
    wanted = values.get(_TEST_STIMULI, ExperimentManagerConfig().protocol.n_stimuli_per_test)
    if _TEST_STIMULI in given and type(wanted) is int and wanted > n_test:
        raise InputError(
            f"{given[_TEST_STIMULI].by}: expected {n_test} or less, as many test stimuli there are"
        )
    values[_TEST_STIMULI] = min(wanted, n_test) if type(wanted) is int else wanted


def _check_tests(values: Mapping[str, Any], given: Mapping[str, Given]) -> None:
    """Refuse tests that were asked for and cannot be made; a profile's are left out then."""
    end = values.get(_ITERATIONS, ExperimentManagerConfig().protocol.n_training_iterations)
    if _TESTS not in given or type(end) is not int or not isinstance(values[_TESTS], list):
        return
    beyond = [n for n in values[_TESTS] if type(n) is int and n > end]
    if beyond:
        raise InputError(
            f"{given[_TESTS].by}: expected training iterations up to {end}, the end of training, "
            f"got {beyond[0]}"
        )


def _built(node: str, values: Mapping[str, Any]) -> Any:
    try:
        return build(CONFIG_CLASSES[node], values)
    except InputError as error:
        raise InputError(f"{node}: {error}") from error


def _read_setting(text: str) -> tuple[str, Any]:
    target, equals, value = text.partition("=")
    if target == _SCHEDULE:
        return target, value  # a parameter that is YAML itself
    node, dot, _ = target.partition(".")
    if not equals or not dot or node not in CONFIG_CLASSES:
        raise InputError(
            f"--set: expected NODE.PARAMETER=VALUE with a node of {', '.join(CONFIG_CLASSES)}, "
            f"got {text!r}" + (did_you_mean(node, CONFIG_CLASSES) if dot else "")
        )
    try:
        read = yaml.safe_load(value)
    except yaml.YAMLError as error:
        raise InputError(f"--set {text}: expected a value as YAML has it") from error
    return target, _number(read) if isinstance(read, str) else read


def _number(text: str) -> float | str:
    """Return the number that a text is, or the text: YAML takes 1e-5 for a word."""
    try:
        return float(text)
    except ValueError:
        return text
