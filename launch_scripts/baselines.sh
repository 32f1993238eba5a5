#!/usr/bin/env bash
# Test other methods as a run was tested: registration, an energy model, ridge regression, CMA-ES, SAC, PPO.
#
# usage: launch_scripts/baselines.sh RUN... [options]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

abv baselines "$@"
