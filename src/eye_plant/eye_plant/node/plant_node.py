"""The node eye_plant: pictures and muscle states out, episodes and muscle commands in."""

import sys
from typing import Any

from eye_plant.config import EyePlantConfig
from eye_plant.node.free_running import FreeRunning
from eye_plant.node.lockstep_plant import LockstepPlant
from eye_plant.node.publisher import ObservationPublisher
from eye_plant.observation import Observation
from eye_plant.plant import EyePlant
from lockstep import InputError
from lockstep.node.diagnostics import Diagnostics
from lockstep.node.process import run_node
from lockstep.node.requests import RECONFIGURE, START_RUN, Arguments
from lockstep.node.ros_parameters import declare_config
from lockstep.wire.stamps import check_stamp, period_ns


class EyePlantNode(LockstepPlant[EyePlant, Observation]):
    """Two eyes; with `free_running.rate_hz` above 0 they wait for nobody; see `FreeRunning`."""

    def __init__(self, **kwargs: Any) -> None:
        """Set up the plant; raises InputError when its configuration cannot be met."""
        super().__init__("eye_plant", **kwargs)
        config = declare_config(self, EyePlantConfig)
        self.plant = EyePlant(config)
        self._period_ns = period_ns(config.mechanics.period_s)
        is_free = config.free_running.rate_hz > 0.0
        # In lockstep what it receives can wait until the sender's turn is over.
        self.gives_way = not is_free
        self.diagnostics = Diagnostics(
            self, (lambda: {"state": "free running"}) if is_free else self._state_of_run
        )
        self._publisher = ObservationPublisher(self, config)
        self.get_logger().info(
            f"{self.plant.n_stimuli} stimuli resident, {config.mechanics.parameter_set} eyes"
        )
        if is_free:
            self._free_running = FreeRunning(
                self, config, self.plant, self._publisher, self.diagnostics
            )
        else:
            self._wait_for_episodes(
                "muscle_command", {START_RUN: self._start_run, RECONFIGURE: self._reconfigure}
            )

    def _start_run(self, arguments: Arguments) -> None:
        self._end_run(arguments)
        self._reconfigure({})

    def _reconfigure(self, arguments: Arguments) -> None:
        """Take over other settings for the episodes to come; {} are those of the start."""
        if self._observation is not None and self.plant.is_waiting:
            raise InputError(
                f"{RECONFIGURE}: expected between episodes, got during one, at observation "
                f"{self._observation.number}"
            )
        self.plant.reconfigure(arguments)
        self._publisher.reconfigure(self.plant.config)

    def check_episode(self, last_observation: int) -> None:
        """Refuse an episode whose stamps ROS does not have."""
        check_stamp(last_observation, self._period_ns)

    def stamp_ns(self, observation: Observation) -> int:
        """Return simulated time: it counts the control periods of the run."""
        return observation.number * self._period_ns

    def send(self, stamp_ns: int, observation: Observation) -> None:
        """Publish an observation."""
        self._publisher.publish(stamp_ns, observation)


def main() -> None:
    """Run the node until it is told to stop."""
    sys.exit(run_node(EyePlantNode))
