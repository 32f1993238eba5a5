"""What people import and command: what is done with runs and their learners.

>>> import active_binocular_vision as abv
>>> run = abv.run("demonstration", seed=2)  # train and test, in this process
>>> run.results  # the measures of its tests, as a data frame
>>> abv.compare([run, abv.Run("runs/other")])
>>> print(abv.examine("gaze", "cover").text())  # what trained eyes do when one is covered

Its modules are imported only when a name of theirs is asked for.
"""

from typing import TYPE_CHECKING

from lockstep.lazy_names import lazy_names

if TYPE_CHECKING:
    from active_binocular_vision.learners.learners import FrozenLearners
    from active_binocular_vision.runs.groups import groups_of
    from active_binocular_vision.runs.run import Run
    from active_binocular_vision.study import compare, examine, run
    from eye_plant import EyePlant, Head, run_head
    from sparse_coder import SparseCoder
    from vergence_rl import Agent

__all__ = [
    "Agent",
    "EyePlant",
    "FrozenLearners",
    "Head",
    "Run",
    "SparseCoder",
    "compare",
    "examine",
    "groups_of",
    "run",
    "run_head",
]

_MODULES = {
    "active_binocular_vision.learners.learners": "FrozenLearners",
    "active_binocular_vision.runs.groups": "groups_of",
    "active_binocular_vision.runs.run": "Run",
    "active_binocular_vision.study": "compare examine run",
    "eye_plant": "EyePlant Head run_head",
    "sparse_coder": "SparseCoder",
    "vergence_rl": "Agent",
}
__getattr__ = lazy_names(__name__, _MODULES)
