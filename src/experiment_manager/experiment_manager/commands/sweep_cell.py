"""run_experiment.sh as the child of a sweep, which it does not outlive."""

import sys

from experiment_manager.commands.run_experiment import main
from experiment_manager.run.lasting_output import make_standard_streams_last
from lockstep.node.own_process import die_with

if __name__ == "__main__":
    parent, *line = sys.argv[1:]
    die_with(int(parent))
    make_standard_streams_last()
    sys.exit(main(line))
