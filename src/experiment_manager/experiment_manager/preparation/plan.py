"""What a run is going to do, in a few lines before it starts."""

from experiment_manager.experiment.config import ExperimentManagerConfig
from experiment_manager.experiment.protocol import Protocol, make_protocol
from experiment_manager.run.config_file import Configuration
from eye_plant.config import EyePlantConfig
from lockstep.configuration import build

# For a first idea; the bar knows better.
ASSUMED_RATE_HZ = 250


def plan(configuration: Configuration) -> list[str]:
    """Return how long training and tests are, and what is done instead of what was asked for."""
    manager = build(ExperimentManagerConfig, configuration["experiment_manager"])
    protocol = make_protocol(manager)
    return [_tests(protocol), *_left_out(protocol), *_stimuli(configuration, protocol)]


def _tests(protocol: Protocol) -> str:
    config = protocol.config
    n_tests = len(protocol.test_iterations)
    n_iterations = n_tests * protocol.n_trials * config.iterations_per_trial
    return (
        f"{config.n_training_iterations:,} training iterations, and {n_tests} tests of "
        f"{protocol.n_trials:,} trials: {n_iterations:,} iterations more, about "
        f"{n_iterations / ASSUMED_RATE_HZ / 60:.1f} minutes at {ASSUMED_RATE_HZ} iterations/s "
        "(--test-stimuli K makes tests shorter)"
    )


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
