"""From the request of a run to its effective configuration, by section."""

from collections.abc import Mapping
from typing import Any

from experiment_manager.plant_changes import Schedule
from experiment_manager.preparation.controls import check_control
from experiment_manager.preparation.profiles import Profile, read_profile
from experiment_manager.preparation.request import (
    ITERATIONS,
    MODEL,
    SCHEDULE,
    TEST_STIMULI,
    TESTS,
    WEIGHT,
    Given,
    RunRequest,
)
from experiment_manager.reach import check_reach
from experiment_manager.sections import (
    DEFAULTS,
    Configuration,
    by_key,
    by_section,
    completed,
    config_of,
)
from eye_plant import EyePlantConfig
from eye_plant.stimuli.stimulus_set import count_stimuli
from lockstep import InputError
from lockstep.task import DEFAULT_METABOLIC_COST_WEIGHTS


def profile_of(request: RunRequest) -> Profile:
    """Return the profile that a request names or implies; InputError for an unknown name."""
    is_paper = request.model is not None or request.iterations is not None
    return read_profile(request.profile or ("paper" if is_paper else "demonstration"))


def configuration_of(request: RunRequest, commit: str) -> Configuration:
    """Return the configuration of a new run, complete and checked.

    Raises InputError for whatever a node would refuse.
    """
    profile = profile_of(request)
    settings = by_key(profile.settings) | {
        "experiment_manager.profile": profile.name,
        "experiment_manager.commit": commit,
        SCHEDULE: schedule_of(profile, request).text(),
    }
    return configuration_with(settings, request)


def schedule_of(profile: Profile, request: RunRequest) -> Schedule:
    """Return the profile's schedule, put off as the request asks.

    Raises InputError for a delay below 0, and one without a schedule of the profile's to put off.
    """
    delay = request.schedule_delay
    if delay is None:
        return profile.schedule
    by = request.by("schedule_delay")
    if not profile.schedule.changes or SCHEDULE in request.overrides:
        raise InputError(f"{by}: expected a profile that has a schedule, and no other schedule")
    if delay < 0:
        raise InputError(f"{by}: expected 0 training iterations or more, got {delay}")
    return profile.schedule.delayed(delay)


def configuration_with(settings: Mapping[str, Any], request: RunRequest) -> Configuration:
    """Return a complete configuration: settings by key, and above them what a request asks.

    Raises InputError for whatever a node would refuse, and for what contradicts itself.
    """
    given = request.settings()
    values = dict(settings) | {key: setting.value for key, setting in given.items()}
    _count_stimuli(values, given)
    if WEIGHT not in given and (MODEL in given or WEIGHT not in values):
        values[WEIGHT] = _default_weight(values)
    _check_tests(values, given)
    try:
        configuration = completed(by_section(values))
    except InputError as error:
        raise _in_words_of_request(error, given) from error
    _check_lambda(configuration, request, given)
    check_control(request.control, request.by("control"), configuration["task"]["command_space"])
    check_reach(configuration)
    return configuration


def _default_weight(values: Mapping[str, Any]) -> float:
    if values.get(MODEL, "M") == "M":
        return 0.0
    default = DEFAULTS["eyes"]["mechanics.parameter_set"]
    return DEFAULT_METABOLIC_COST_WEIGHTS[values.get("eyes.mechanics.parameter_set", default)]


def _check_lambda(
    configuration: Configuration, request: RunRequest, given: Mapping[str, Given]
) -> None:
    if configuration["experiment_manager"]["model"] != "M":
        return
    weight = configuration["task"]["metabolic_cost_weight"]
    if weight > 0.0:
        by = given[WEIGHT].by if WEIGHT in given else "metabolic_cost_weight"
        raise InputError(
            f"{by}: expected 0 with model M, whose reward counts no energy, got {weight:g}; "
            "model M_C has one"
        )


def _count_stimuli(values: dict[str, Any], given: Mapping[str, Given]) -> None:
    """Set how many stimuli there are, and that a test has no more than that."""
    try:
        plant = config_of(EyePlantConfig, by_section(values))
    except InputError as error:
        raise _in_words_of_request(error, given) from error
    n_training, n_test = count_stimuli(plant.stimuli)
    found = {"n_training_stimuli": n_training, "n_test_stimuli": n_test}
    for name, n_stimuli in found.items():
        key = f"experiment_manager.{name}"
        if key in given and given[key].value != n_stimuli:
            raise InputError(f"{given[key].by}: expected {n_stimuli}, as eye_plant.stimuli has")
        values[key] = n_stimuli
    wanted = values.get(TEST_STIMULI, DEFAULTS["experiment_manager"]["n_stimuli_per_test"])
    if TEST_STIMULI in given and type(wanted) is int and wanted > n_test:
        raise InputError(
            f"{given[TEST_STIMULI].by}: expected {n_test} or less, the number of test stimuli"
        )
    values[TEST_STIMULI] = min(wanted, n_test) if type(wanted) is int else wanted


def _check_tests(values: Mapping[str, Any], given: Mapping[str, Given]) -> None:
    """Refuse tests that were asked for and cannot be made; a profile's are left out then."""
    end = values.get(ITERATIONS, DEFAULTS["task"]["n_training_iterations"])
    if TESTS not in given or type(end) is not int or not isinstance(values[TESTS], list):
        return
    beyond = [n for n in values[TESTS] if type(n) is int and n > end]
    if beyond:
        raise InputError(
            f"{given[TESTS].by}: expected training iterations up to {end}, the end of training, "
            f"got {beyond[0]}"
        )


def _in_words_of_request(error: InputError, given: Mapping[str, Given]) -> InputError:
    """Return an error about a setting as one about what gave the setting its value."""
    name, _, wrong = str(error).partition(": ")
    for key, setting in given.items():
        if key.partition(".")[2] == name:
            return InputError(f"{setting.by}: {wrong}")
    return error
