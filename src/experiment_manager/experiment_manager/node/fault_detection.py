"""What is a fault of a run, and what can be waited out. No ROS."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from experiment_manager.run.episode_record import EpisodeRecord, learning_steps
from lockstep import InputError
from lockstep.exit_codes import EXIT_FAULT, EXIT_UNWRITABLE

# Whose answer each topic carries.
LEARNER_OF = {"reward": "sparse_coder", "actor_critic": "vergence_rl"}
# Beyond it an absent node is taken for lost: DDS finds others within seconds of a network's return.
LOST_S = 60.0


@dataclass(frozen=True)
class Fault:
    """Why the run cannot go on, and the exit code that says so."""

    reason: str
    exit_code: int = EXIT_FAULT


@dataclass(frozen=True)
class Wait:
    """What the run waits for, since it may yet come."""

    reason: str


def of_error(error: InputError | OSError, directory: Path) -> Fault:
    """Return the fault of refused input, or of a run directory that cannot be written."""
    if isinstance(error, InputError):
        return Fault(str(error))
    return Fault(f"{directory} cannot be written: {error}", EXIT_UNWRITABLE)


def of_refusal(name: str, kind: str, reason: str) -> Fault:
    """Return the fault of a node that refuses a request.

    A state that cannot be saved now cannot be saved by another attempt either.
    """
    code = EXIT_UNWRITABLE if kind == "save" else EXIT_FAULT
    return Fault(f"{name} refused {kind}: {reason}", code)


def of_silence(
    gap_s: float, missing: str, absent_topics: Sequence[str], silent_s: float, *, supervised: bool
) -> Fault | Wait:
    """Return what it means that nothing has come for gap_s while messages are missing.

    missing: in words; absent_topics: those without a publisher; silent_s: since the last message,
    whatever was waited for. The plant repeats itself, so a node that comes back can still answer.
    Under supervision a node that is present but silent hangs. One that is absent was not started by
    the supervisor, which would know of its end: it may be behind a broken network. After LOST_S the
    supervisor's nodes restart, and wait for it then: DDS may have lost sight of it for good.
    """
    text = f"no message for {gap_s:g} s; missing: {missing}"
    if not absent_topics:
        return Fault(text) if supervised else Wait(text)
    absent = ", ".join(absent_topics)
    if supervised and silent_s > max(LOST_S, 2.0 * gap_s):
        return Fault(f"no publisher of {absent} for {silent_s:.0f} s")
    return Wait(f"waiting for {absent}")


def check_learning_steps(topic: str, record: EpisodeRecord, stamp_ns: int, found: float) -> None:
    """Raise InputError for a learner that was restarted, or learned what it should not have."""
    expected = learning_steps(topic, record.episode, record.iteration(stamp_ns))
    if found != expected:
        raise InputError(
            f"{LEARNER_OF[topic]}: expected {expected} learning steps in episode "
            f"{record.episode.episode}, got {found:g}"
        )
