#!/usr/bin/env bash
# Evaluate a run: vergence error and energy in each of its tests, or in a new test of its learners.
#
# usage: launch_scripts/evaluate.sh RUN [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module active_binocular_vision.command_lines.evaluate "$@"
