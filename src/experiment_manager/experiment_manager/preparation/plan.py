"""What a run is going to do, in a few lines before it starts."""

from experiment_manager.experiment.protocol import Protocol, protocol_of
from experiment_manager.experiment.sections import config_of
from experiment_manager.run.config_file import Configuration
from eye_plant.config import EyePlantConfig
from eye_plant.stimuli.stimulus_set import StimuliConfig, count_missing

# For a first idea; the bar knows better.
ASSUMED_RATE_HZ = 250
# As two cores generate 140 pictures of 1920 x 1920 px, in a minute.
_PX_PER_S = 140 * 1920**2 / 60.0
# Training iterations after which runs in results/ had learned something, by learning rule: vergence
# from 2 deg to a median of 0.4 deg or less (demonstration; paper), and model M_C to save a tenth of
# the energy (demonstration; paper_short). Each is the earliest test there is, except the last.
_LEARNED_AFTER = {"hindsight": 10_000, "cacla": 50_000}
_SAVES_AFTER = {"hindsight": 50_000, "cacla": 200_000}


def plan(configuration: Configuration, place: int = 0) -> list[str]:
    """Return how long training and tests are, and what is done instead of what was asked for.

    place: episodes that are already done, as a checkpoint has them.
    """
    protocol = protocol_of(configuration)
    return [
        _left(protocol, place) if place else _length(protocol),
        *_too_short(configuration, protocol),
        *_left_out(protocol),
        *_stimuli(configuration, protocol),
    ]


def preparation(stimuli: StimuliConfig) -> str:
    """Return how the pictures are got before a run starts, "" when all are there."""
    if stimuli.directory:
        return f"reading the pictures of {stimuli.directory}"
    n_missing = count_missing(stimuli)
    if not n_missing:
        return ""
    time_s = n_missing * stimuli.size_px**2 / _PX_PER_S
    duration = "some seconds" if time_s < 30.0 else f"about {_duration(max(time_s, 60.0))}"
    what = "1 stimulus, which is" if n_missing == 1 else f"{n_missing:,} stimuli, which are"
    return f"generating {what} kept for later runs ({duration})"


def _length(protocol: Protocol) -> str:
    n_training = protocol.config.n_training_iterations
    n_tests = len(protocol.test_iterations)
    n_of_tests = protocol.trials_from(0) * protocol.config.iterations_per_trial
    return (
        f"{n_training:,} training iterations, and {n_of_tests:,} in {_counted(n_tests, 'test')} of "
        f"{_counted(protocol.n_trials, 'trial')}: {_together(n_training + n_of_tests)} "
        "(--test-stimuli K makes tests shorter)"
    )


def _left(protocol: Protocol, place: int) -> str:
    end = protocol.config.n_training_iterations
    n_training = end - protocol.training_iterations_before(place)
    n_trials = protocol.trials_from(place)
    if not n_training + n_trials:
        return f"nothing is left: all {end:,} training iterations and all tests are done"
    n_of_tests = n_trials * protocol.config.iterations_per_trial
    return (
        f"left: {n_training:,} of {end:,} training iterations, and {n_of_tests:,} in "
        f"{_counted(n_trials, 'trial')} of tests: {_together(n_training + n_of_tests)}"
    )


def _counted(n: int, what: str) -> str:
    return f"{n:,} {what}" if n == 1 else f"{n:,} {what}s"


def _together(n_iterations: int) -> str:
    duration = _duration(n_iterations / ASSUMED_RATE_HZ)
    return f"together about {duration} at {ASSUMED_RATE_HZ} iterations/s"


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
    wanted = config_of(EyePlantConfig, configuration).stimuli
    found = protocol.config.n_training_stimuli, protocol.config.n_test_stimuli
    if not wanted.directory or found == (wanted.n_training, wanted.n_test):
        return []
    return [
        f"{wanted.directory}: {_counted(found[0], 'picture')} to train with and {found[1]} to test "
        f"with, in place of {wanted.n_training} and {wanted.n_test}"
    ]
