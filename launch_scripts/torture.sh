#!/usr/bin/env bash
# Disturb runs on purpose, for as long as you like: nodes killed and stopped at random points, killed or
# short of memory while they start, hostile input, the network between two hosts cut, the clock set far ahead and back,
# a long run. It works in slices; with --totals it adds them up in a file and goes on from there, whenever it was broken
# off.
#
# usage: launch_scripts/torture.sh [--kills N] [--inputs N] [--cuts N] [--jumps N] [--soak ITERATIONS]
#                                  [--start-kills N] [--memory-limits N] [--seed S] [--totals FILE] [--out DIR]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module tests.stress "$@"
