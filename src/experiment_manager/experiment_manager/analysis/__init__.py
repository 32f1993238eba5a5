"""What a finished run shows: only reads runs, and writes figures, tables and films."""
