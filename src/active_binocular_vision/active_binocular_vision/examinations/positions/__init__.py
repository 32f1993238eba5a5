"""Nine gaze positions: what eyes that make saccades do there, beside the least energy."""
