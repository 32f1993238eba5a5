"""What the exit codes of nodes and commands mean, and how a node's log gives the reason."""

EXIT_DIFFERENT = 1  # abv evaluate: results.json is not what the bag says
EXIT_BAD_INPUT = 2
EXIT_FAULT = 3
EXIT_UNWRITABLE = 4  # the disk is full, or may only be read: starting again would not help
EXIT_NETWORK = 5  # of an attempt only: the nodes began without a network that is there now
EXIT_DIVERGED = 6  # of a node or an attempt: learning ran away, and would do so again
EXIT_ROLL_BACK = 7  # of a manager without a supervisor, which then begins again by itself
EXIT_INTERRUPTED = 130

# Before the reason, in the last line of a node's log: the supervisor reads it there.
FAULT_TEXT = "the run cannot continue: "
