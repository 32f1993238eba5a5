#!/usr/bin/env bash
# Measure what a run has learned: vergence error and energy after each of its tests.
#
# usage: launch_scripts/evaluate.sh RUN [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module experiment_manager.commands.evaluate "$@"
