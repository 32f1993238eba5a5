"""What people import and command: what is done with runs and their learners.

Its modules are imported only when a name of theirs is asked for.
"""

from typing import TYPE_CHECKING

from lockstep.lazy_names import lazy_names

if TYPE_CHECKING:
    from active_binocular_vision.learners.learners import FrozenLearners
    from active_binocular_vision.runs.finished_run import FinishedRun
    from active_binocular_vision.runs.groups import groups_of

__all__ = [
    "FinishedRun",
    "FrozenLearners",
    "groups_of",
]

_MODULES = {
    "active_binocular_vision.learners.learners": "FrozenLearners",
    "active_binocular_vision.runs.finished_run": "FinishedRun",
    "active_binocular_vision.runs.groups": "groups_of",
}
__getattr__ = lazy_names(__name__, _MODULES)
