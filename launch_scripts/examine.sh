#!/usr/bin/env bash
# Test the learners of a run again: as in its own tests, before other images, or as in an eye clinic.
#
# usage: launch_scripts/examine.sh RUN [--cover|--acuity|...] [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv examine "$@"
