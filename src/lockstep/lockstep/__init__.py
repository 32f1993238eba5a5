"""The protocol between the nodes, and nothing of the science.

Importing this package imports no ROS; the modules that need rclpy import it themselves.
"""
