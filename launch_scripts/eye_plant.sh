#!/usr/bin/env bash
# Start the eye plant alone: two eyes with twelve muscles in MuJoCo, and their pictures.
#
# usage: launch_scripts/eye_plant.sh [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE ...]
#
# Its parameters and their defaults: launch_scripts/list_parameters.sh eye_plant
# environment: ROS_DOMAIN_ID, the ROS domain (default 42, as for all nodes that are started one by one)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv plant "$@"
