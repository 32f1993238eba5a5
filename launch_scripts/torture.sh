#!/usr/bin/env bash
# Disturb runs on purpose: kill and stop nodes at random points, kill them or limit their
# memory while they start, send hostile input, cut the network between two hosts, set the clock far ahead and back, make
# a long run. It works in slices; with --totals it adds up their totals in a file and continues there after an
# interruption.
#
# usage: launch_scripts/torture.sh [--kills N] [--inputs N] [--cuts N] [--jumps N] [--soak ITERATIONS]
#                                  [--start-kills N] [--memory-limits N] [--seed S] [--totals FILE] [--out DIR]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

run_module tests.stress "$@"
