"""Nine gaze positions: posture, energy, and the laws of Sherrington, Listing and Hering."""
