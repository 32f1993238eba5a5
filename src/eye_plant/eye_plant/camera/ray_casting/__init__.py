"""Drawing by casting rays, in compiled loops."""
