"""Both parameter sets held against physiology and OpenEyeSim's maps."""
