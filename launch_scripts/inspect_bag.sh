#!/usr/bin/env bash
# Show, export, film or repair a bag.
#
# usage: launch_scripts/inspect_bag.sh BAG [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv bag "$@"
