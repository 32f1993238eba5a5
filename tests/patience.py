"""How long a test waits for what must come: its end, not its measure."""

import os

# Two cores with ten times the work that they can do still get there. Where a run gets next to
# nothing, as at the lowest priority beside others, the environment allows more.
PATIENCE_S = float(os.environ.get("ABV_PATIENCE_S", "600"))
