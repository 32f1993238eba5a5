"""The nodes of a run by their names, which are those of their packages."""

MANAGER = "experiment_manager"
# All except the recorder may run on another machine.
MOVABLE_NODES = ("eye_plant", "sparse_coder", "vergence_rl")
NODES = (*MOVABLE_NODES, MANAGER)
