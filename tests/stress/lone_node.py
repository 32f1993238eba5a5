"""A node that somebody starts without a supervisor."""

import os
import sys
from collections.abc import Sequence
from contextlib import AbstractContextManager
from functools import partial
from pathlib import Path

from lockstep.machine.own_process import die_with
from tests.supervisor import started


class LoneNode(AbstractContextManager["LoneNode"]):
    """The process of a node, killed when the block is left."""

    def __init__(
        self, package: str, config: Path, domain: int, log: Path, prefix: Sequence[str] = ()
    ) -> None:
        """config: the run's config.yaml, or a copy; prefix: a command that becomes the node."""
        node = [sys.executable, "-m", f"{package}.node", "--ros-args", "--params-file", str(config)]
        variables = {"ROS_DOMAIN_ID": str(domain), "PYTHONUNBUFFERED": "1"}
        with log.open("a") as output:
            self.process = started(
                [*prefix, *node], variables, output, preexec_fn=partial(die_with, os.getpid())
            )

    def __exit__(self, *exception: object) -> None:
        """End the node."""
        self.process.kill()
        self.process.wait()
