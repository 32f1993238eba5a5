#!/usr/bin/env bash
# Compare the simulated eyes with physiology; writes plant_validation.json, a list of {name, value, unit, bound, ok}.
#
# usage: launch_scripts/validate_plant.sh [--out DIR]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv validate-plant "$@"
