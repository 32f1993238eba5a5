#!/usr/bin/env bash
# Test what a run has learned, on its own test stimuli or on other images.
#
# usage: launch_scripts/evaluate.sh RUN [--stimuli DIR] [more options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module experiment_manager.evaluation "$@"
