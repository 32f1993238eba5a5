#!/usr/bin/env bash
# Disturb runs on purpose: kill and stop nodes and supervisors at random points, and send hostile input. The numbers are
# compared with those of undisturbed runs.
#
# usage: launch_scripts/torture.sh [--kills N] [--inputs N] [--seed S] [--out DIR] [--json FILE]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

start tools.stress "$@"
