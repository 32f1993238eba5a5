#!/usr/bin/env bash
# Recompute the measures of a run from its bag, and compare them with its results.json.
#
# usage: launch_scripts/evaluate.sh RUN
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv evaluate "$@"
