"""Measures the speed of the graph and of the loop in one process: benchmark.sh."""
