"""What a run is going to do, in a few lines before it starts."""

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import Protocol, make_protocol
from experiment_manager.run.config_file import Configuration
from eye_plant.config import EyePlantConfig
from lockstep.configuration import build

# For a first idea; the bar knows better.
ASSUMED_RATE_HZ = 250
# Training iterations after which runs in results/ had learned something, by learning rule: vergence
# to a median error of 0.2 deg or less (demonstration; paper), and model M_C to save a tenth of the
# energy (precise; paper_short). Each is the earliest test there is, but for the last.
_LEARNED_AFTER = {"hindsight": 10_000, "cacla": 50_000}
_SAVES_AFTER = {"hindsight": 100_000, "cacla": 200_000}


def plan(configuration: Configuration) -> list[str]:
    """Return how long training and tests are, and what is done instead of what was asked for."""
    manager = build(ExperimentManagerConfig, configuration["experiment_manager"])
    protocol = make_protocol(manager)
    return [
        _length(protocol),
        *_too_short(configuration, protocol),
        *_left_out(protocol),
        *_stimuli(configuration, protocol),
    ]


def _length(protocol: Protocol) -> str:
    config = protocol.config
    n_tests = len(protocol.test_iterations)
    n_of_tests = n_tests * protocol.n_trials * config.iterations_per_trial
    n_iterations = config.n_training_iterations + n_of_tests
    return (
        f"{config.n_training_iterations:,} training iterations, and {n_of_tests:,} in {n_tests} "
        f"test{'s' if n_tests > 1 else ''} of {protocol.n_trials:,} trials: together about "
        f"{_duration(n_iterations / ASSUMED_RATE_HZ)} at {ASSUMED_RATE_HZ} iterations/s "
        "(--test-stimuli K makes tests shorter)"
    )


def _duration(time_s: float) -> str:
    for unit, length_s in (("hours", 3600.0), ("minutes", 60.0)):
        if time_s >= 2.0 * length_s:
            return f"{time_s / length_s:.0f} {unit}"
    return f"{time_s:.0f} seconds"


def _too_short(configuration: Configuration, protocol: Protocol) -> list[str]:
    """Say how long learning takes where a run ends before anything is known to be learned."""
    rule = configuration["vergence_rl"]["learning_rule"]
    if protocol.config.n_training_iterations >= _LEARNED_AFTER[rule]:
        return []
    saving = ""
    if configuration["experiment_manager"]["model"] == "M_C":
        saving = f", and energy saved after {_SAVES_AFTER[rule]:,}"
    return [
        f"that is too short to learn much: in the runs of results/ with this learning rule "
        f"({rule}), vergence was learned after {_LEARNED_AFTER[rule]:,} training iterations{saving}"
    ]


def _left_out(protocol: Protocol) -> list[str]:
    end = protocol.config.n_training_iterations
    beyond = [n for n in protocol.config.test_iterations if n > end]
    if not beyond:
        return []
    return [
        f"training ends at {end:,}: the tests from {min(beyond):,} on are left out, one is made at "
        "the end"
    ]


def _stimuli(configuration: Configuration, protocol: Protocol) -> list[str]:
    wanted = build(EyePlantConfig, configuration["eye_plant"]).stimuli
    found = protocol.config.n_training_stimuli, protocol.config.n_test_stimuli
    if not wanted.directory or found == (wanted.n_training, wanted.n_test):
        return []
    return [
        f"{wanted.directory}: {found[0]} pictures to train with and {found[1]} to test with, in "
        f"place of {wanted.n_training} and {wanted.n_test}"
    ]
