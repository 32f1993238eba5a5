"""Two machines on one: network namespaces with a cable between them that can be cut (Linux, root).

Each host has interfaces, addresses and a /dev/shm of its own, so that nothing but the cable joins
their processes. Both share the disk. All is gone with the process that made it.
"""

import subprocess
from contextlib import AbstractContextManager, ExitStack, closing
from pathlib import Path

from experiment_manager.supervision.domains import NODE_SCRIPTS_DOMAIN
from tests.patience import PATIENCE_S
from tests.supervisor import LoneNode

_PROFILE = Path(__file__).parents[1] / "src/lockstep/lockstep/machine/network.xml"
# As launch_scripts/environment.sh has it for graphs across machines.
_VARIABLES = ("ROS_AUTOMATIC_DISCOVERY_RANGE=SUBNET", f"FASTRTPS_DEFAULT_PROFILES_FILE={_PROFILE}")
# Says so when it is set up, and ends when nobody holds the other end of its input any more.
_ANCHOR = "mount -t tmpfs tmpfs /dev/shm && ip link set lo up && echo ready && exec cat"


class Host:
    """A machine: a command that begins with its prefix takes part there in graphs across both."""

    def __init__(self, address: str) -> None:
        """address: of its end of the cable. Raises OSError when this user cannot make it."""
        self.address = address
        self._anchor = subprocess.Popen(
            ["unshare", "--net", "--mount", "--propagation=private", "sh", "-c", _ANCHOR],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
        )
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
        self._anchor.communicate(timeout=PATIENCE_S)


class NodeOnHost(LoneNode):
    """A node that somebody started on a host, in the domain of nodes started one by one."""

    def __init__(self, host: Host, package: str, config: Path) -> None:
        """config: the run's config.yaml, or a copy; the node's log is written beside it."""
        log = config.with_name(f"{package}.log")
        super().__init__(package, config, NODE_SCRIPTS_DOMAIN, log, host.prefix)


class TwoHosts(AbstractContextManager["TwoHosts"]):
    """Hosts a and b with a cable between them, which are gone when the block is left."""

    def __init__(self) -> None:
        """Raise OSError when this user or this machine cannot make them."""
        with ExitStack() as hosts:
            self.a = hosts.enter_context(closing(Host("10.77.0.1")))
            self.b = hosts.enter_context(closing(Host("10.77.0.2")))
            link = ("ip", "link", "add", "cable", "type", "veth", "peer", "cable", "netns")
            self.a.run(*link, str(self.b.process_id))
            for host in (self.a, self.b):
                host.run("ip", "address", "add", f"{host.address}/24", "dev", "cable")
            self.heal()
            self._hosts = hosts.pop_all()

    def __exit__(self, *exception: object) -> None:
        """Let go of both hosts, and with them of the cable."""
        self._hosts.close()

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
