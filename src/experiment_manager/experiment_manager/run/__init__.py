"""One run on disk: where it stands, what it has recorded, its checkpoints."""
