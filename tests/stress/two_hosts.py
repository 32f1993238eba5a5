"""Two machines on one: network namespaces with a cable between them that can be cut (Linux, root).

Each host has interfaces, addresses and a /dev/shm of its own, so that nothing but the cable joins
their processes. Both share the disk. All is gone with the process that made it.
"""

import os
import subprocess
import sys
from functools import partial
from pathlib import Path
from typing import Self

from experiment_manager.supervision.domains import NODE_SCRIPTS_DOMAIN
from lockstep.machine.own_process import die_with
from tests.patience import PATIENCE_S

_PROFILE = Path(__file__).parents[2] / "src/lockstep/config/fastdds.xml"
# As launch_scripts/environment.sh has it for graphs across machines.
_VARIABLES = ("ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET", f"FASTRTPS_DEFAULT_PROFILES_FILE={_PROFILE}")
# Says so when it is set up, and ends when nobody holds the other end of its input any more.
_ANCHOR = "mount -t tmpfs tmpfs /dev/shm && ip link set lo up && echo ready && exec cat"


class Host:
    """A machine: a command that begins with its prefix takes part there in graphs across both."""

    def __init__(self, address: str) -> None:
        """address: of its end of the cable. Raises OSError when this user cannot make it."""
        self.address = address
        try:
            self._anchor = subprocess.Popen(
                ["unshare", "--net", "--mount", "--propagation=private", "sh", "-c", _ANCHOR],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
            )
        except FileNotFoundError as error:
            raise OSError("no unshare on this machine (util-linux)") from error
        assert self._anchor.stdout is not None
        said = self._anchor.stdout.readline().strip()
        if said != "ready":
            self.close()
            raise OSError(f"no namespaces for this user: {said}")
        self.process_id = self._anchor.pid
        self._enter = ("nsenter", f"--target={self.process_id}", "--net", "--mount", "--")
        self.prefix = (*self._enter, "env", *_VARIABLES)

    def run(self, *command: str) -> str:
        """Run a command to its end; return what it printed."""
        done = subprocess.run(
            [*self._enter, *command],
            capture_output=True,
            text=True,
            check=False,
            timeout=PATIENCE_S,
        )
        if done.returncode:
            raise OSError(f"{' '.join(command)}: {done.stderr.strip()}")
        return done.stdout

    def close(self) -> None:
        """Let go of the host; it goes when its last process has ended."""
        self._anchor.communicate()


class NodeOnHost:
    """A node that somebody started on a host, in the domain of nodes started one by one."""

    def __init__(self, host: Host, package: str, config: Path) -> None:
        """config: the run's config.yaml, or a copy; the node's log is written beside it."""
        command = [sys.executable, "-m", f"{package}.node", "--ros-args"]
        domain = f"ROS_DOMAIN_ID={NODE_SCRIPTS_DOMAIN}"
        with config.with_name(f"{package}.log").open("ab") as log:
            self._process = subprocess.Popen(
                [*host.prefix, domain, *command, "--params-file", str(config)],
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                preexec_fn=partial(die_with, os.getpid()),  # noqa: PLW1509 (no threads yet)
            )

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *exception: object) -> None:
        """End the node."""
        self._process.kill()
        self._process.wait()


class TwoHosts:
    """Hosts a and b with a cable between them."""

    def __init__(self) -> None:
        """Raise OSError when this user or this machine cannot make them."""
        self.a = Host("10.77.0.1")
        try:
            self.b = Host("10.77.0.2")
        except OSError:
            self.a.close()
            raise
        try:
            link = ("ip", "link", "add", "cable", "type", "veth", "peer", "cable", "netns")
            self.a.run(*link, str(self.b.process_id))
            for host in (self.a, self.b):
                host.run("ip", "address", "add", f"{host.address}/24", "dev", "cable")
            self.heal()
        except OSError:
            self.close()
            raise

    def cut(self) -> None:
        """Pull the cable."""
        self._set("down")

    def heal(self) -> None:
        """Plug the cable in again."""
        self._set("up")

    def _set(self, state: str) -> None:
        for host in (self.a, self.b):
            host.run("ip", "link", "set", "cable", state)

    def n_bytes(self) -> int:
        """Return how many bytes have come over the cable from b to a."""
        devices = self.a.run("cat", "/proc/net/dev").splitlines()
        cable = next(line for line in devices if "cable:" in line)
        return int(cable.partition(":")[2].split()[0])

    def n_lost(self) -> int:
        """Return how many packets found no way out of a."""
        names, values = (
            line.split()
            for line in self.a.run("cat", "/proc/net/snmp").splitlines()
            if line.startswith("Ip:")
        )
        return int(values[names.index("OutNoRoutes")])

    def close(self) -> None:
        """Let go of both hosts, and with them of the cable."""
        for host in (self.a, self.b):
            host.close()

    def __enter__(self) -> Self:
        """Return itself."""
        return self

    def __exit__(self, *exception: object) -> None:
        """Close."""
        self.close()
