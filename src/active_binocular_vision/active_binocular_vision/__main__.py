"""What `python -m active_binocular_vision` runs."""

from active_binocular_vision.command_lines.abv import main

main()
