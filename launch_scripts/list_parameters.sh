#!/usr/bin/env bash
# List the parameters of the nodes: meaning, unit, bounds, default.
#
# usage: launch_scripts/list_parameters.sh [NODE...]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv parameters "$@"
