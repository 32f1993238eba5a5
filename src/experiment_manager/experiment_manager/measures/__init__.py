"""What a run is measured by: errors, costs, results and tables."""
