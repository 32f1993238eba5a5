"""The node experiment_manager: asks for one episode after another, and records them all."""

import os
import sys
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

from rclpy.clock import Clock, ClockType
from rclpy.node import Node
from rclpy.subscription import Subscription
from sensor_msgs.msg import JointState

from experiment_manager.config import ExperimentManagerConfig
from experiment_manager.node.fault_detection import Fault, of_error, of_silence
from experiment_manager.node.parameters import NodeParameters, Parameters
from experiment_manager.node.presence import Presence
from experiment_manager.node.recorder import Recorder
from experiment_manager.node.requests import LEARNERS, PLANT, Ask, Requests
from experiment_manager.run.recorded_topics import small_topics
from experiment_manager.run.run_directory import Run
from eye_plant import Episode
from lockstep import InputError
from lockstep.exit_codes import EXIT_BAD_INPUT, EXIT_INTERRUPTED, EXIT_ROLL_BACK, FAULT_TEXT
from lockstep.machine.own_process import give_back_blocks_of
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.parameter_files import parameter_arguments
from lockstep.node.process import run_node
from lockstep.node.requests import END_RUN, RECONFIGURE, START_RUN, Arguments
from lockstep.node.ros_parameters import declare_config
from lockstep.wire.qos import LOCKSTEP_QOS
from lockstep.wire.stamps import NS_PER_S
from lockstep.wire.topics import PARAMETER_CHANGES

# Until the nodes have met, somebody is waiting.
_START_PERIOD_S = 0.05
_WATCH_PERIOD_S = 0.5
# Pictures are kept for one episode in some hundreds; from the heap their memory would not come
# back, a little more of it each time.
_PICTURE_BYTES = 1 << 16


class ExperimentManagerNode(Node):
    """Drives a run: graph matched, run started, episodes one by one, checkpoints, results."""

    # Nobody waits for what is recorded.
    gives_way = True

    def __init__(self, **kwargs: Any) -> None:
        """Open the run directory; raises InputError when it cannot be used."""
        super().__init__("experiment_manager", **kwargs)
        self.exit_code = 0
        self.config = declare_config(self, ExperimentManagerConfig)
        try:
            self.run = Run(self.config)
        except OSError as error:
            raise InputError(f"run directory: expected one to write into: {error}") from error
        self._n_awaited = 0
        self._n_interrupts = 0
        self._is_over = self._may_have_restarted = False
        self._said_waiting = ""
        self.diagnostics = Diagnostics(self, self._state_of_run)
        self._changes = self.create_publisher(JointState, PARAMETER_CHANGES, LOCKSTEP_QOS)
        self._plant_settings: Arguments = {}
        topics = small_topics(self.config)
        self._presence = Presence(self, topics)
        self._parameters = NodeParameters(self, topics, self._guarded)
        self._requests = Requests(self, self.run.run_id, self._guarded, self._fault, self._welcome)
        self._recorder = Recorder(self, self.run, self.config, self._guarded, self._end_episode)
        if self.config.supervised:
            self._recorder.checked_learners = self._requests.names
        self._next: Callable[[], None] = self._await_graph
        self._watch_timer = self.create_timer(
            _START_PERIOD_S,
            partial(self._guarded, self._look),
            clock=Clock(clock_type=ClockType.STEADY_TIME),
        )
        self.get_logger().info(f"run {self.run.run_id} in {self.run.directory}")

    def awaited_subscriptions(self) -> list[Subscription]:
        """Return the messages that are worth waking up for; see LockstepExecutor."""
        return self._recorder.awaited_subscriptions()

    # The start

    def _await_graph(self) -> None:
        """Start the run once every topic has its publisher, and who answers requests is known."""
        missing = self._presence.unmatched_topics()
        if missing:
            self._say_waiting(f"waiting for {', '.join(missing)}")
            self._requests.wait_from_now()
            return
        awaited = self._requests.awaited()
        if awaited:
            self._say_waiting(f"waiting for the request service of {', '.join(awaited)}")
            return
        self._next = self._parameters.watch
        self._parameters.ask(self._describe)

    def _describe(self, parameters: Parameters) -> None:
        """Write down with what the nodes run; where they contradict each other, nothing starts."""
        try:
            self.run.describe(parameters)
        except InputError as error:
            self._fault(Fault(str(error), EXIT_BAD_INPUT))
        else:
            self._start_run()

    def _say_waiting(self, text: str) -> None:
        if text != self._said_waiting:
            self.get_logger().info(text)
            self._said_waiting = text

    def _start_run(self) -> None:
        self._next = _nothing
        self._watch_timer.timer_period_ns = round(_WATCH_PERIOD_S * NS_PER_S)
        self._recorder.sample_pictures()
        loads = self._loads(self._requests.learners)
        self._requests.ask_each(START_RUN, lambda: self._requests.ask(loads, self._next_episode))

    def _loads(self, learners: Sequence[str]) -> list[Ask]:
        """Return the requests that give learners their states of the newest checkpoint."""
        states = self.run.states_to_load(learners)
        return [(name, "load", {"path": str(path)}) for name, path in states.items()]

    def _welcome(self, name: str) -> list[Ask]:
        """Return the requests that take a learner into the run which a person has started again.

        The plant is not among them: it would begin an episode again that learners know in part.
        """
        if self.config.supervised or name not in LEARNERS:
            return []
        self.get_logger().warning(f"{name} was started again: it gets its last checkpoint's state")
        return [(name, START_RUN, {}), *self._loads([name])]

    # Episodes

    def _next_episode(self) -> None:
        self._next = _nothing
        is_last = self.run.is_over or self._n_interrupts > 0
        # A learner that was started again is found by what it is asked for a checkpoint.
        is_due, self._may_have_restarted = (
            self.run.checkpoint_is_due() or self._may_have_restarted,
            False,
        )
        if is_last or is_due:
            self._checkpoint(self._finish if is_last else self._request)
        else:
            self._request()

    def _request(self) -> None:
        """Ask for the next episode; before it, for the plant that the schedule has for it."""
        settings = self.run.plant_settings()
        if settings == self._plant_settings:
            self._request_episode()
            return
        self._plant_settings = settings
        self._requests.ask([(PLANT, RECONFIGURE, settings)], self._request_episode)

    def _request_episode(self) -> None:
        if change := self.run.begin_episode():
            self._changes.publish(change)
        episode = self.run.episode()
        self._recorder.sample_pictures()
        self._recorder.begin(episode)
        self._n_awaited = 1
        self._ask_for(episode, self._acknowledged)

    def _ask_for(self, episode: Episode, then: Callable[[], None]) -> None:
        self._n_awaited += 1
        self._requests.ask([(PLANT, "episode", episode.as_arguments())], then)

    def _acknowledged(self) -> None:
        # The plant is busy now; what is drawn here costs the run no time.
        self.run.prepare()
        self._go_on()

    def _end_episode(self) -> None:
        # What another publisher may have had a part in does not get into a checkpoint: while there
        # is doubt, the watch comes back to it.
        if not self._is_alone() or self._is_over:
            return
        self._recorder.end()
        self.diagnostics.count()
        self.run.end_episode()
        self._go_on()

    def _go_on(self) -> None:
        """Begin the next episode when the last one is both acknowledged and recorded."""
        self._n_awaited -= 1
        if self._n_awaited == 0:
            self._next_episode()

    # Checkpoints and the end

    def _checkpoint(self, then: Callable[[], None]) -> None:
        learners = self._requests.learners
        if len(learners) < len(LEARNERS):
            self.run.commit_bag()
            then()
            return
        paths = self.run.state_paths(learners)

        def commit() -> None:
            self.run.commit(paths)
            then()

        self._requests.ask(
            [(name, "save", {"path": str(path)}) for name, path in paths.items()], commit
        )

    def _finish(self) -> None:
        if self.run.is_over:
            self.run.finish()
        else:
            self.exit_code = EXIT_INTERRUPTED
        self._requests.ask_each(END_RUN, self._stop)

    def _stop(self) -> None:
        self._is_over = True
        self._recorder.close()
        try:
            self.run.close()
        except OSError as error:
            self.get_logger().error(f"{self.run.directory} cannot be written: {error}")
        self.context.try_shutdown()

    def interrupt(self) -> None:
        """Stop after the episode under way, with a checkpoint; the second time, at once.

        Called from a signal handler, in the midst of anything: the watch acts on it.
        """
        self._n_interrupts += 1

    def destroy_node(self) -> None:
        """Close the bag with the node, if the run was ended from outside."""
        if not self._is_over:
            self.exit_code = EXIT_INTERRUPTED
            self._stop()
        super().destroy_node()

    # Faults

    def _look(self) -> None:
        if self._is_over:
            return
        # Before the first episode there is nothing to wait for.
        if self._n_interrupts > 1 or (self._n_interrupts and self._next is not _nothing):
            self.exit_code = EXIT_INTERRUPTED
            self._stop()
            return
        self._next()
        self.run.writer.flush_when_due()
        record = self._recorder.record
        if record is not None and record.is_complete:
            self._end_episode()
        elif record is not None:
            self._is_alone()
            self._look_for_silence(record.missing())

    def _is_alone(self) -> bool:
        """Whether each topic has one publisher; it is a fault when some certainly has another."""
        certain, doubtful = self._presence.doubled_topics()
        if certain:
            topics = ", ".join(certain)
            self._fault(Fault(f"expected one publisher per topic, found more on {topics}"))
        elif doubtful:
            self._may_have_restarted = True
            self._say_waiting(
                f"waiting for one of two publishers of {', '.join(doubtful)} to go: of a node that "
                "was killed and started again, the first one is counted until its lease ends"
            )
        return not certain and not doubtful

    def _look_for_silence(self, missing: str) -> None:
        gap_s, supervised = self.config.gap_s, self.config.supervised
        if self._recorder.silent_s <= gap_s:
            return
        absent, silent_s = self._presence.absent_topics(), self._recorder.unheard_s
        # A node that was away may be another process now.
        self._may_have_restarted |= bool(absent)
        found = of_silence(gap_s, missing, absent, silent_s, supervised=supervised)
        if isinstance(found, Fault):
            self._fault(found)
        else:
            self._say_waiting(found.reason)
            self._recorder.wait_from_now()
            if not supervised and self._n_awaited == 1:
                # Acknowledged once more, except by a plant that was started again.
                self._ask_for(self.run.episode(), self._go_on)

    def _guarded(self, act: Callable[[], None]) -> None:
        """Act; input that is refused and a disk that refuses are faults."""
        try:
            act()
        except (InputError, OSError) as error:
            self._fault(of_error(error, self.run.directory))

    def _fault(self, fault: Fault) -> None:
        if self._is_over:
            return
        self.exit_code = fault.exit_code
        if fault.exit_code == EXIT_ROLL_BACK and not self.config.supervised:
            self.get_logger().warning(f"{fault.reason}: rolling back to the newest checkpoint")
        else:
            self.get_logger().error(f"{FAULT_TEXT}{fault.reason}")
        self._stop()

    def _state_of_run(self) -> dict[str, str]:
        return {"episode": str(self.run.place), "episodes": str(len(self.run.protocol))}


def _nothing() -> None:
    pass


def main() -> None:
    """Run the node until its run is over; without a supervisor, roll it back where that helps."""
    give_back_blocks_of(_PICTURE_BYTES)
    made: list[ExperimentManagerNode] = []

    def make_node() -> Node:
        made.append(ExperimentManagerNode())
        return made[0]

    code = run_node(make_node)
    if code == EXIT_ROLL_BACK and not made[0].config.supervised:
        directory = str(made[0].run.directory.resolve())
        words = parameter_arguments({"run_directory": directory, "resume": True})
        again = [sys.executable, "-m", __package__, *sys.argv[1:], "--ros-args", *words]
        os.execv(sys.executable, again)
    sys.exit(code)
