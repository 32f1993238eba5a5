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

apt_get() {
  DEBIAN_FRONTEND=noninteractive apt-get -qq --no-install-recommends -o DPkg::Lock::Timeout=120 "$@" </dev/null
}

# Adds packages of the system, and changes none that is there.
install_packages() {
  say "installing $* with apt-get"
  apt_get update >/dev/null && would=$(apt_get install --simulate "$@") || fail "apt-get does not know $*."
  ! grep -q '^Remv\|^Inst [^ ]* \[' <<<"$would" || fail "apt-get would change other packages for $*: install them yourself."
  apt_get install -y "$@" >/dev/null || fail "apt-get could not install $*; its message is above."
}

python_fits() {
  "$1" -I -c 'import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null
}

# Sets base_python.
find_python() {
  local candidate candidates=(python3 python3.13 python3.12 python3.11 python3.14)
  [[ -z ${ABV_PYTHON:-} ]] || candidates=("$ABV_PYTHON")
  for candidate in "${candidates[@]}"; do
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

# What this script did not make, such as a link to the environment of another checkout, is set aside as it is.
clear_environment() {
  local aside
  aside=$venv.$(date +%Y%m%d-%H%M%S)
  if [[ -L $venv || -e $venv && ! -f $venv/set_up && -n $(ls -A "$venv") ]]; then
    mv -T "$venv" "$aside" || fail "expected $venv to be made by this script: move it away"
    say "$venv was not made by this script: it is now $aside"
  fi
  mkdir -p "$venv"
  : >"$venv/set_up.new"
  mv "$venv/set_up.new" "$venv/set_up" # empty: made by this script, unfinished
  find "$venv" -mindepth 1 -maxdepth 1 ! -name set_up -exec rm -rf --one-file-system {} +
  cp "$(type -P true)" "$venv/true"
  "$venv/true" || fail "expected a folder in which programs may be started, $root is mounted with noexec."
  rm "$venv/true"
}

install_lock() {
  pip_install --require-hashes --no-compile --no-deps "$@" || fail "pip could not install what requirements.lock names; its message is above."
}

make_environment() {
  local n_packages
  n_packages=$(grep -c '^[a-z]' "$root/requirements.lock")
  clear_environment
  say "making a Python environment in .venv"
  "$base_python" -I -m venv "$venv" || fail "$base_python could not make an environment in $venv."
  say "installing $n_packages Python packages into it (a minute or two, once)"
  # setuptools first: it builds the one package that has no wheel, so that nothing unpinned is fetched for that.
  install_lock -r <(awk '/^[a-z]/ {ours = /^setuptools==/} ours' "$root/requirements.lock")
  install_lock --no-build-isolation --use-pep517 -r "$root/requirements.lock"
  say "compiling them"
  "$python" -m compileall -q -j 0 "$venv/lib" >/dev/null || true # only saves time at the first start
  # The six packages, imported from src, with the command abv and what Gymnasium finds.
  pip_install --no-deps --no-build-isolation --editable "$root" || fail "pip could not install this project; its message is above."
}

require_own_environment() {
  [[ -L $venv || ! -e $venv || -w $venv ]] || fail "$venv belongs to the user $(stat -c %U "$venv"), and as $(id -un) you can" \
    "neither use nor change it: work in a checkout of your own (git clone $root), or have its owner make it again with a" \
    "Python that everybody may start, for example: ABV_PYTHON=/usr/bin/python3 launch_scripts/setup.sh --again"
}

# Also compiles what numba would compile at the first start.
check_imports() {
  local said
  said=$("$python" -c 'import eye_plant.plant, sparse_coder.node, vergence_rl.node, experiment_manager.node' 2>&1) ||
    fail "what was installed cannot be imported: ${said##*$'\n'}"
}

main() {
  case ${1:-} in
    -h | --help)
      show_help
      exit
      ;;
    --again | '') ;;
    *) fail "expected no argument or --again, got $1" ;;
  esac
  exec {lock}<"$root" # whoever comes second waits, and finds the work done
  flock "$lock" || say "this file system has no locks: start nothing else here meanwhile"
  [[ ${1:-} == --again ]] || ! is_set_up || exit 0
  require_own_environment
  [[ $(uname -sm) == "Linux x86_64" ]] || fail "ROS 2 comes as wheels for x86-64 Linux only; this is $(uname -sm)."
  require_python
  export_variables "$base_python"
  make_environment
  check_imports
  fingerprint >"$venv/set_up.new"
  mv "$venv/set_up.new" "$venv/set_up" # last, so that an interrupted set-up is made again
  say "done"
}

main "$@"
