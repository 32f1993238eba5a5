#!/usr/bin/env bash
# Measure the speed of the graph, of the same loop in one process, and of their stages.
#
# usage: launch_scripts/benchmark.sh [--quick] [--json FILE] [--against REV]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

start tools.benchmark "$@"
