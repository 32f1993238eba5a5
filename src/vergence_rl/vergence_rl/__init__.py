"""Reinforcement learning of eye movements: muscle commands that lead to reward.

Importing this package imports no ROS.
"""

from vergence_rl.agent import Agent
from vergence_rl.config import VergenceRlConfig
from vergence_rl.learning_rule import Decision, LearningRule, RuleConfig, Task, TimeStep

__all__ = [
    "Agent",
    "Decision",
    "LearningRule",
    "RuleConfig",
    "Task",
    "TimeStep",
    "VergenceRlConfig",
]
