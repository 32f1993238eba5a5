#!/usr/bin/env bash
# Write the eyes as MJCF, both parameter sets, with a README of their own: for mujoco.viewer and other people's projects.
#
# usage: launch_scripts/export_model.sh DIR
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module eye_plant.export "$@"
