# SPDX-License-Identifier: Apache-2.0
# Shell functions that turn a bare Debian 12 machine into one that has posespace built.
# Source it:  . deploy/setup.sh
#
# Every function says what it does, does nothing when there is nothing to do, and stops the script
# with a message when it fails.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { if [ -t 1 ]; then printf '\033[1m==> %s\033[0m\n' "$*"; else printf '==> %s\n' "$*"; fi; }
fail() { printf 'error: %s\n' "$*" >&2; exit 1; }

# install_packages [NAME...]: everything in deploy/packages.txt, and NAMEs.
install_packages() {
  local wanted missing=() name
  command -v dpkg-query >/dev/null || fail "this needs Debian 12 (or a system with apt)"
  wanted="$(grep -v '^#' deploy/packages.txt) $*"
  for name in $wanted; do
    dpkg-query -W -f '${db:Status-Abbrev}' "$name" 2>/dev/null | grep -q '^ii' || missing+=("$name")
  done
  if [ ${#missing[@]} -eq 0 ]; then return; fi
  local root=""
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail "installing packages needs root or sudo: ${missing[*]}"
    root=sudo
  fi
  say "Installing ${#missing[@]} Debian packages: ${missing[*]}"
  $root apt-get update -qq || fail "apt-get update failed"
  $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
    "${missing[@]}" >/dev/null || fail "apt-get install failed"
}

# build PRESET [TARGET...]: configures and builds; all targets when none is named.
build() {
  local preset=$1
  shift
  export CCACHE_BASEDIR=$PWD CCACHE_NOHASHDIR=1  # clones elsewhere share what was compiled
  if [ ! -f "build/$preset/build.ninja" ]; then
    say "Configuring build/$preset"
    cmake --preset "$preset" >"/tmp/posespace-configure.$$" 2>&1 ||
      { cat "/tmp/posespace-configure.$$"; fail "cmake --preset $preset failed"; }
    rm -f "/tmp/posespace-configure.$$"
  fi
  say "Building build/$preset (minutes, the first time)"
  local targets=() name
  for name in "$@"; do targets+=(--target "$name"); done
  local quiet=()
  [ -t 1 ] || quiet=(-- --quiet)  # ninja's progress is one line on a terminal, thousands in a log
  cmake --build --preset "$preset" ${targets[@]+"${targets[@]}"} ${quiet[@]+"${quiet[@]}"} ||
    fail "the build failed"
}

# make_venv [REQUIREMENTS]: build/venv with the Python client, and what REQUIREMENTS lists; each again
# only when it changed.
make_venv() {
  [ -x build/venv/bin/python ] || python3 -m venv build/venv || fail "python3 -m venv failed"
  local sources
  sources=$(git ls-files -co --exclude-standard client/python proto)
  pip_install "the Python client" "$sources" ./client/python
  if [ $# -gt 0 ]; then pip_install "what the tests need" "$1" -r "$1"; fi
}

# pip_install WHAT FILES ARGUMENT...: runs pip install ARGUMENT... in build/venv unless FILES are the
# same as the last time.
pip_install() {
  local what=$1 files=$2 stamp stamp_file="build/venv/stamp-${1// /-}"
  shift 2
  stamp=$(sha256sum $files)
  if [ "$(cat "$stamp_file" 2>/dev/null)" = "$stamp" ]; then return; fi
  say "Installing $what into build/venv"
  build/venv/bin/python -m pip install --quiet --disable-pip-version-check "$@" ||
    fail "pip install failed"
  echo "$stamp" >"$stamp_file"
}
