#!/usr/bin/env bash
# Set up all that the project needs, once: a Python environment in .venv with what requirements.lock names. The other
# scripts call this by themselves; when all is done it returns at once. As root on Debian or Ubuntu it installs a
# missing Python with apt, elsewhere it names the packages.
#
# usage: launch_scripts/setup.sh [--again]
#   --again   make the environment again from nothing
#
# environment: ABV_PYTHON, the Python to use (3.11 to 3.14; default: the first that fits)
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

say() {
  printf 'setup: %s\n' "$*" >&2
}

fail() {
  say "$@"
  exit 1
}

may_install() {
  [[ $(id -u) == 0 ]] && command -v apt-get >/dev/null
}

install_packages() {
  say "installing $* with apt-get"
  if ! {
    apt-get update -qq
    DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends -o DPkg::Lock::Timeout=120 "$@"
  } </dev/null >/dev/null; then
    fail "apt-get could not install $*; its message is above."
  fi
}

python_fits() {
  "$1" -I -c 'import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null
}

# Sets base_python.
find_python() {
  local candidate
  for candidate in ${ABV_PYTHON:-python3 python3.13 python3.12 python3.11 python3.14}; do
    if python_fits "$candidate"; then
      base_python=$candidate
      return
    fi
  done
  return 1
}

require_python() {
  find_python && return
  [[ -z ${ABV_PYTHON:-} ]] || fail "ABV_PYTHON=$ABV_PYTHON is not a Python 3.11 to 3.14 with its venv module."
  if may_install; then
    install_packages python3 python3-venv
    find_python && return
  fi
  fail "Python 3.11 to 3.14 with its venv module is needed, for example: sudo apt install python3 python3-venv"
}

pip_install() {
  "$python" -m pip install --quiet --no-input --disable-pip-version-check --no-compile --no-user --no-deps \
    --require-hashes "$@" || fail "pip could not install what requirements.lock names; its message is above."
}

make_environment() {
  local n_packages
  n_packages=$(grep -c '^[a-z]' "$root/requirements.lock")
  say "installing $n_packages Python packages into .venv (a minute or two, once)"
  "$base_python" -I -m venv --clear "$venv" || fail "$base_python could not make an environment in $venv."
  # setuptools first: it builds the one package that has no wheel, so that nothing unpinned is fetched for that.
  pip_install -r <(awk '/^[a-z]/ {ours = /^setuptools==/} ours' "$root/requirements.lock")
  pip_install --no-build-isolation --use-pep517 -r "$root/requirements.lock"
  "$python" -m compileall -q -j 0 "$venv/lib" >/dev/null || true # only saves time at the first start
  # From that folder on: Python reads the file in the encoding of the locale, and $root may have an umlaut.
  printf '../../../../src/%s\n' lockstep eye_plant sparse_coder vergence_rl experiment_manager active_binocular_vision \
    >"$(echo "$venv"/lib/python3*/site-packages)/active_binocular_vision.pth"
}

require_own_environment() {
  [[ ! -e $venv || -w $venv ]] || fail "$venv belongs to the user $(stat -c %U "$venv"), and as $(id -un) you can" \
    "neither use nor change it: work in a checkout of your own (git clone $root), or have its owner make it again with a" \
    "Python that everybody may start, for example: ABV_PYTHON=/usr/bin/python3 launch_scripts/setup.sh --again"
}

# Compiles what numba would compile at the first start. That start would show an error better than we can here.
compile_numerics() {
  "$python" -c 'import eye_plant.plant, sparse_coder.coder, vergence_rl.agent' >/dev/null 2>&1 || true
}

main() {
  case ${1:-} in
    -h | --help)
      show_help
      exit
      ;;
    --again)
      require_own_environment
      rm -f "$venv/set_up"
      ;;
    '') ;;
    *) fail "expected no argument or --again, got $1" ;;
  esac
  exec {lock}<"$root" # whoever comes second waits, and finds the work done
  flock "$lock"
  is_set_up && exit
  require_own_environment
  [[ $(uname -sm) == "Linux x86_64" ]] || fail "ROS 2 comes as wheels for x86-64 Linux only; this is $(uname -sm)."
  export_variables
  rm -f "$venv/set_up"
  require_python
  make_environment
  compile_numerics
  fingerprint >"$venv/set_up.new"
  mv "$venv/set_up.new" "$venv/set_up" # last, so that an interrupted set-up is made again
  say "done"
}

main "$@"
