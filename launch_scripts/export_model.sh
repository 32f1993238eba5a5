#!/usr/bin/env bash
# Write the eyes of both parameter sets as MJCF, with a README: for mujoco.viewer and other projects.
#
# usage: launch_scripts/export_model.sh [--out DIR]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv export-model "$@"
