"""A run brought to its end: processes, heartbeats, roll-back after a fault, ROS domains."""
