#!/usr/bin/env bash
# Build the site of all pages in build/site, with its tutorials run, and open it in the browser.
#
# usage: launch_scripts/docs.sh [--check]
#   --check   stop at any warning, run no tutorial, open nothing
set -euo pipefail
# shellcheck source=launch_scripts/environment.sh
source "$(dirname "${BASH_SOURCE[0]}")/environment.sh"

packages=$venv/docs # a folder of its own, as some are older than those that the tests need

install_packages() {
  cmp -s requirements-docs.lock "$packages/lock" && return
  echo "docs: installing Sphinx (a minute, once)" >&2
  rm -rf "$packages"
  pip_install --require-hashes --target "$packages" --no-deps -r requirements-docs.lock
  cp requirements-docs.lock "$packages/lock" # last, so that an interrupted installation is made again
}

case ${1:-} in
  -h | --help)
    show_help
    exit
    ;;
  --check) options=(--fresh-env --fail-on-warning --keep-going --define nb_execution_mode=off) ;;
  '') options=() ;;
  *)
    echo "docs.sh: error: expected no argument or --check, got $1" >&2
    exit 2
    ;;
esac
set_up
cd "$root"
install_packages
"$python" docs/generated.py build/reference
PYTHONPATH=$packages "$python" -m sphinx --quiet --conf-dir docs "${options[@]}" . build/site
if [[ $# == 0 ]]; then
  echo "file://$root/build/site/index.html"
  "$python" -m webbrowser "file://$root/build/site/index.html" >/dev/null
fi
