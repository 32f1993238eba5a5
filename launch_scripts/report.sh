#!/usr/bin/env bash
# Draw the figures of one or more runs from their bags and results, and write report.html.
#
# usage: launch_scripts/report.sh RUN... [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv report "$@"
