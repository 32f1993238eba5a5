# The scripts in this folder source this file: it has the project's paths and starts one entry point.
# shellcheck shell=bash

root=$(builtin cd "$(dirname "${BASH_SOURCE[0]}")/.." >/dev/null && pwd -P) # with CDPATH, cd says where it went
venv=$root/.venv
python=$venv/bin/python
variables=$root/src/lockstep/lockstep/machine/environment.py # what becomes of the environment, and why

# What the environment in .venv was made from. Another lock file, set-up script, folder or Python means: make it again.
fingerprint() {
  cat "$root/requirements.lock" "$root/launch_scripts/setup.sh" | sha256sum
  printf '%s\n' "$root"
  "$python" -I -S -c 'import sys; print(sys.version)'
}

is_set_up() {
  [[ -x $python && -s $venv/set_up ]] && [[ $(fingerprint 2>/dev/null) == "$(<"$venv/set_up")" ]]
}

# The comment at the head of the script that was started is its help.
show_help() {
  sed -n '2,${/^#/!q; s/^# \{0,1\}//p}' "$0"
}

# Names what numba compiles. A cached function that calls one of another file does not notice when that one changes, and
# crashes: so other sources have a cache of their own.
compiled_sources() {
  find "$root/src" -name '*.py' -exec grep -lZ numba {} + 2>/dev/null | LC_ALL=C sort -z | xargs -0r cat | sha256sum | cut -c 1-16
}

export_variables() { # as this Python says
  local commands
  commands=$("$1" -I -S "$variables")
  eval "$commands"
  export NUMBA_CACHE_DIR=${NUMBA_CACHE_DIR:-$venv/numba_cache/$(compiled_sources)}
}

# pip_install ARGUMENTS...: install, from where pip's own settings say, whatever else these say.
pip_install() (
  settings=$(PIP_QUIET=0 PIP_VERBOSE=0 "$python" -m pip config list) &&
    commands=$("$python" -I -S "$variables" pip <<<"$settings") &&
    eval "$commands" &&
    "$python" -m pip install --quiet --no-input --disable-pip-version-check "$@"
)

set_up() {
  is_set_up || "$root/launch_scripts/setup.sh" || exit
  export_variables "$python"
}

# start MODULE ARGUMENTS...: become this module. Its help is longer than the script's, once all is set up.
start() {
  if [[ ${2:-} == --help || ${2:-} == -h || ${3:-} == --help || ${3:-} == -h ]] && ! is_set_up; then
    show_help
    printf '\nAll options are listed here once launch_scripts/setup.sh has run.\n'
    exit
  fi
  set_up
  [[ $1 != tools.* ]] || export PYTHONPATH=$root # these are not among the packages
  export ABV_COMMAND=launch_scripts/abv.sh # what messages call it
  exec "$python" -m "$@"
}

# abv COMMAND ARGUMENTS...: become this command.
abv() {
  start active_binocular_vision "$@"
}
