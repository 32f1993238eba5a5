#!/usr/bin/env bash
# Start the learner alone: it turns features and reward into muscle commands.
#
# usage: launch_scripts/vergence_rl.sh [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE ...]
#
# Its parameters and their defaults: launch_scripts/list_parameters.sh vergence_rl
# environment: ROS_DOMAIN_ID, the ROS domain (default 42, as for all nodes that are started one by one)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv agent "$@"
