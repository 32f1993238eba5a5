#!/usr/bin/env bash
# Start the sparse coder alone: it turns picture pairs into features and reward, and learns its basis functions.
#
# usage: launch_scripts/sparse_coder.sh [--ros-args -p NAME:=VALUE -r FROM:=TO --params-file FILE ...]
#
# Its parameters and their defaults: launch_scripts/list_parameters.sh sparse_coder
# environment: ROS_DOMAIN_ID, the ROS domain (default 42, as for all nodes that are started one by one)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv coder "$@"
