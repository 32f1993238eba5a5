#!/usr/bin/env bash
# Make many runs that differ in a few options, several at a time, each in one process on one core, or as a job array of
# Slurm. Started again, it continues the unfinished runs. Ctrl-C stops all runs, with checkpoints. See docs/how_to/sweep.md
#
# usage: launch_scripts/sweep.sh SWEEP.yaml [--out DIR] [--stimuli DIR] [--jobs N | --slurm [more options]]
#        launch_scripts/sweep.sh DIR [--status] [--jobs N]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv sweep "$@"
