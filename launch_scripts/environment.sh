# The scripts in this folder source this file: it has the project's paths and starts one entry point.
# shellcheck shell=bash

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd -P)
venv=$root/.venv
python=$venv/bin/python
node_domain=42

# What the environment in .venv was made from. Another lock file, set-up script, folder or Python means: make it again.
fingerprint() {
  cat "$root/requirements.lock" "$root/launch_scripts/setup.sh" | sha256sum
  printf '%s\n' "$root"
  "$python" -I -S -c 'import sys; print(sys.version)'
}

is_set_up() {
  [[ -x $python && -f $venv/set_up ]] && [[ $(fingerprint 2>&1) == "$(<"$venv/set_up")" ]]
}

# The comment at the head of the script that was started is its help.
show_help() {
  sed -n '2,${/^#/!q; s/^# \{0,1\}//p}' "$0"
}

without_other_ros() { # a colon-separated list of folders, less those of another ROS installation
  local folder kept=
  while IFS= read -r -d : folder; do
    [[ -z $folder || $folder == /opt/ros/* || $folder == */ros_*.libs ]] || kept+=${kept:+:}$folder
  done <<<"$1:"
  printf '%s' "$kept"
}

# Names what numba compiles. A cached function that calls one of another file does not notice when that one changes, and
# crashes: so other sources have a cache of their own.
compiled_sources() {
  find "$root/src" -name '*.py' -exec grep -lZ numba {} + 2>/dev/null | LC_ALL=C sort -z | xargs -0r cat | sha256sum | cut -c 1-16
}

export_variables() {
  # rclpy comes from .venv. One from a sourced ROS installation would be found before it.
  unset PYTHONPATH PYTHONHOME AMENT_PREFIX_PATH _ROS_WHEELS_BOOTSTRAP_COMPLETE
  LD_LIBRARY_PATH=$(without_other_ros "${LD_LIBRARY_PATH:-}")
  export LD_LIBRARY_PATH
  export HOME=${HOME:-~} # ROS writes its logs there and fails without
  unset RMW_IMPLEMENTATION # the lock file has only one
  export NUMBA_CACHE_DIR=${NUMBA_CACHE_DIR:-$venv/numba_cache/$(compiled_sources)}
}

set_up() {
  is_set_up || "$root/launch_scripts/setup.sh" || exit
  export_variables
  local variables
  variables=$("$python" -I -S "$root/src/lockstep/lockstep/machine/environment.py" "$root/src/lockstep/config")
  eval "$variables"
}

# run_module MODULE ARGUMENTS...: become the entry point, which has a longer help than ours.
run_module() {
  if [[ ${2:-} == --help || ${2:-} == -h ]] && ! is_set_up; then
    show_help
    printf '\nAll options are listed here once launch_scripts/setup.sh has run.\n'
    exit
  fi
  set_up
  [[ $1 != tools.* ]] || export PYTHONPATH=$root # these are not among the packages
  exec "$python" -m "$@"
}

# run_node PACKAGE ARGUMENTS...: become this node.
run_node() {
  local package=$1
  shift
  if [[ ${1:-} == --help || ${1:-} == -h ]]; then
    show_help
    exit
  fi
  set_up
  export ROS_DOMAIN_ID=${ROS_DOMAIN_ID:-$node_domain}
  exec "$python" -m "$package.node" "$@"
}
