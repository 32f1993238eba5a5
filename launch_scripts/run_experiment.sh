#!/usr/bin/env bash
# Run an experiment with all its nodes: train, test, record, draw. Without arguments it runs a demonstration that
# learns vergence and reciprocal innervation in 75,000 iterations. Ctrl-C ends the run cleanly and prints how to resume it.
#
# usage: launch_scripts/run_experiment.sh [--model M|M_C] [--iterations N] [--seed S] [--stimuli DIR] [--out DIR]
#                                         [--resume DIR] [more options]
#
# environment: ROS_DOMAIN_ID, the ROS domain (default: a free one, which it prints, so that other tools can subscribe)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv run "$@"
