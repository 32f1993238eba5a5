#!/usr/bin/env bash
# The command abv: everything that the other scripts start, by name, set up first where it is not yet.
#
# usage: launch_scripts/abv.sh COMMAND [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv "$@"
