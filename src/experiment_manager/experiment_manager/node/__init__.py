"""The node experiment_manager: drives the graph through its episodes and records them."""

from experiment_manager.node.manager_node import main

__all__ = ["main"]
