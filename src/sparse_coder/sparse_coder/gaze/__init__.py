"""What saccades need of the pictures: where to look, and how the eyes turned (D22)."""
