"""What `python -m experiment_manager.node` runs."""

from experiment_manager.node import main

main()
