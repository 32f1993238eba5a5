"""What docs/reference/topics.md says, for the tests that hold it against the code."""

import csv
import re
from pathlib import Path

from lockstep.wire import topics
from tests.pair import ACTOR_CRITIC_NAMES, COMMAND_NAMES

_FOLDER = Path(__file__).parents[1] / "docs" / "reference"
PAGE = (_FOLDER / "topics.md").read_text()
_HEAD, *ROWS = csv.reader((_FOLDER / "vectors.csv").read_text().splitlines())
VECTORS = {
    "episode": topics.EPISODE_NAMES,
    "ground_truth": topics.GROUND_TRUTH_NAMES[len(topics.EPISODE_NAMES) :],
    "eye_states": topics.EYE_STATE_NAMES,
    "reward": topics.reward_names(),
    "muscle_command": COMMAND_NAMES,
    "actor_critic": ACTOR_CRITIC_NAMES,
}


def table(section: str, i_table: int = 0) -> list[list[str]]:
    """Return the cells of a section's table, without its head."""
    text = PAGE.split(f"\n## {section}\n")[1].split("\n## ")[0]
    found = [block for block in re.split(r"\n\s*\n", text) if block.lstrip().startswith("|")]
    lines = found[i_table].strip().splitlines()[2:]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def quoted(cell: str) -> list[str]:
    """Return what a cell has in code spans."""
    return re.findall(r"`([^`]+)`", cell)
