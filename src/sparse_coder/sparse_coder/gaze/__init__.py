"""What turns of the eyes need of the pictures: where to look, how the eyes turned (D22, D23)."""
