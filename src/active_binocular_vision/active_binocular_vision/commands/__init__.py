"""One module for each script of launch_scripts that users call."""
