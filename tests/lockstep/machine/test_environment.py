"""The environment of nodes: their profile of Fast DDS follows how far they are to reach."""

from pathlib import Path

import pytest

from lockstep.machine.environment import node_environment, reaches_other_machines

CONFIG = Path(__file__).parents[3] / "src/lockstep/config"
RANGE, PROFILE = "ROS_AUTOMATIC_DISCOVERY_RANGE", "FASTRTPS_DEFAULT_PROFILES_FILE"
THIS_MACHINE = {RANGE: "SYSTEM_DEFAULT", PROFILE: str(CONFIG / "this_machine.xml")}
NETWORK = str(CONFIG / "network.xml")


@pytest.mark.parametrize(
    ("given", "expected", "reaches"),
    [
        ({}, THIS_MACHINE, False),
        ({RANGE: "LOCALHOST"}, THIS_MACHINE, False),
        (THIS_MACHINE, THIS_MACHINE, False),  # a script started by a script
        ({RANGE: "SUBNET"}, {RANGE: "SUBNET", PROFILE: NETWORK}, True),
        ({"ROS_STATIC_PEERS": "10.0.0.2"}, {RANGE: "LOCALHOST", PROFILE: NETWORK}, True),
        ({PROFILE: "mine.xml"}, {RANGE: "LOCALHOST", PROFILE: "mine.xml"}, False),
        ({"OMP_NUM_THREADS": "4"}, {"OMP_NUM_THREADS": "4", "OPENBLAS_NUM_THREADS": "1"}, False),
    ],
)
def test_what_a_user_has_set_stays_and_decides(monkeypatch, given, expected, reaches) -> None:
    for name in (*node_environment(CONFIG), "ROS_STATIC_PEERS"):
        monkeypatch.delenv(name, raising=False)
    for name, value in given.items():
        monkeypatch.setenv(name, value)
    variables = node_environment(CONFIG)
    assert expected.items() <= variables.items()
    assert Path(variables[PROFILE]).is_file() or variables[PROFILE] == "mine.xml"
    assert reaches_other_machines(given | variables) == reaches
