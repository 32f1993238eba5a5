#!/usr/bin/env bash
# Check formatting and lint, then types while all tests run. Fails when one of them fails.
#
# The tests are distributed over one process more than there are cores (8 at most), as those of the graph also wait; each module
# stays in one. -n 0 runs them one after the other, as --pdb requires.
#
# usage: launch_scripts/test.sh [pytest arguments, for example tests/sparse_coder -k pursuit -x]
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

if [[ ${1:-} == --help || ${1:-} == -h ]]; then
  show_help
  exit
fi
set_up
cd "$root"
status=0
# The live view's server is optional to users, not to its tests.
"$python" -c 'import foxglove, websockets' 2>/dev/null ||
  pip_install --require-hashes -r requirements-live.lock
unset PYTHONDONTWRITEBYTECODE # else each of the hundreds of processes would compile our modules anew
"$python" -m ruff format --check || status=1
"$python" -m ruff check || status=1
((status == 0)) || echo "test.sh: formatter or linter failed (above); the tests follow" >&2
exec 3< <("$python" -m mypy 2>&1) # keeps one core busy for a while
types=$!
n_cores=$(env -u OMP_NUM_THREADS nproc) # which takes that variable for the number of cores
"$python" -m pytest -n "$((n_cores + 1))" --maxprocesses 8 --max-worker-restart 0 --dist loadscope --no-loadscope-reorder "$@" 3<&- || status=$?
cat <&3 >&2
wait "$types" || { echo "test.sh: type checker failed (above)" >&2 && status=$((status ? status : 1)); }
exit "$status"
