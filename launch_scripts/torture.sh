#!/usr/bin/env bash
# Disturb runs on purpose, for as long as you like: nodes killed and stopped at random points, hostile input, the network
# between two hosts cut, a long run.
#
# usage: launch_scripts/torture.sh [--kills N] [--inputs N] [--cuts N] [--soak ITERATIONS] [--seed S] [--json FILE]
#                                  [--out DIR]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module tests.stress "$@"
