#!/usr/bin/env bash
# Start the live view alone: it shows a graph in Lichtblick or Foxglove. run_experiment.sh --live starts it too.
#
# usage: launch_scripts/live_view.sh [--ros-args -p host:=0.0.0.0 -p port:=8765 -p page_port:=8766 -p rate_hz:=20.0 ...]
#
# environment: ROS_DOMAIN_ID, the ROS domain (default 42, as for all nodes that are started one by one)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv live-view "$@"
