#!/usr/bin/env bash
# Start the experiment manager alone: it requests episodes from eye_plant and records all topics into the bag.
#
# usage: launch_scripts/experiment_manager.sh [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE ...]
#
# Its parameters and their defaults: launch_scripts/list_parameters.sh experiment_manager
# environment: ROS_DOMAIN_ID, the ROS domain (default 42, as for all nodes that are started one by one)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv manager "$@"
