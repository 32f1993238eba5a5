"""The example of a learning rule of one's own, as a run names it."""

from pathlib import Path

EXAMPLE = Path(__file__).parents[1] / "docs" / "examples" / "reinforce.py"
REINFORCE = f"{EXAMPLE}:ReinforceRule"
