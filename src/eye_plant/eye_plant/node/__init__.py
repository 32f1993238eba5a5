"""The node eye_plant: the plant with topics, requests and time."""

from eye_plant.node.plant_node import main

__all__ = ["main"]
