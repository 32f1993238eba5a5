"""Episodes, tests, bags and measures of an experiment.

Importing this package imports no ROS, and its modules only when a name of theirs is asked for.
"""

from typing import TYPE_CHECKING

from lockstep.lazy_names import lazy_names

if TYPE_CHECKING:
    from experiment_manager.bag.reader import Bag, VectorTable
    from experiment_manager.config import ExperimentManagerConfig
    from experiment_manager.loop import InProcessLoop, make_loop
    from experiment_manager.measures.criteria import Criteria, EvaluationSettings
    from experiment_manager.measures.metrics import summary_of
    from experiment_manager.measures.results import Summary
    from experiment_manager.measures.trials import Trials
    from experiment_manager.preparation.configuration import configuration_of
    from experiment_manager.preparation.request import RunRequest
    from experiment_manager.protocol import Protocol, make_protocol, protocol_of
    from experiment_manager.run.config_file import read_configuration

__all__ = [
    "Bag",
    "Criteria",
    "EvaluationSettings",
    "ExperimentManagerConfig",
    "InProcessLoop",
    "Protocol",
    "RunRequest",
    "Summary",
    "Trials",
    "VectorTable",
    "configuration_of",
    "make_loop",
    "make_protocol",
    "protocol_of",
    "read_configuration",
    "summary_of",
]

_MODULES = {
    "experiment_manager.bag.reader": "Bag VectorTable",
    "experiment_manager.config": "ExperimentManagerConfig",
    "experiment_manager.loop": "InProcessLoop make_loop",
    "experiment_manager.measures.criteria": "Criteria EvaluationSettings",
    "experiment_manager.measures.metrics": "summary_of",
    "experiment_manager.measures.results": "Summary",
    "experiment_manager.measures.trials": "Trials",
    "experiment_manager.preparation.configuration": "configuration_of",
    "experiment_manager.preparation.request": "RunRequest",
    "experiment_manager.protocol": "Protocol make_protocol protocol_of",
    "experiment_manager.run.config_file": "read_configuration",
}
__getattr__ = lazy_names(__name__, _MODULES)
