"""The other way round: from a wanted gaze to the activations of the muscles, and what they cost."""
