#!/bin/sh
# Make .venv: what requirements.lock lists, nothing unhashed, and the package itself, editable.
#
#   scripts/set_up.sh READY
#
# READY, a file in .venv, is made last: without one, .venv is the rest of an interrupted set-up.
set -eu
ready=$1
started=$(date +%s)

# Where two makes start at once, the second waits here and finds the work done.
exec 9<requirements.lock
if command -v flock >/dev/null; then flock 9; fi
[ ! -e "$ready" ] || exit 0

python=$(sh scripts/prerequisites.sh)
echo "set-up: making .venv with $("$python" --version), once; about 3 minutes, of which Kwant takes 1 or 2"

ls .venv/ready-* >/dev/null 2>&1 || rm -rf .venv
rm -f .venv/ready-*
[ -d .venv ] || "$python" -m venv .venv

lock() { .venv/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r "$1"; }
lock requirements-uv.lock

# Kwant needs Tinyarray, which is C++.  Debian's gcc comes without g++; then Zig's compiler does it.
cxx=${CXX:-$("$python" -c 'import sysconfig; print(sysconfig.get_config_var("CXX") or "g++")')}
if ! command -v "${cxx%% *}" >/dev/null; then
  echo "set-up: there is no ${cxx%% *}, so Zig's C++ compiler is fetched to build Tinyarray"
  lock requirements-zig.lock
  export CXX="$PWD/scripts/zig-c++" LDCXXSHARED="$PWD/scripts/zig-c++ -shared"
fi

# The lock also pins, with hashes, what Kwant and Tinyarray are built with.
uv() { .venv/bin/uv pip install --python .venv/bin/python "$@"; }
uv --require-hashes --require-build-hashes --preview-features build-dependency-hashes \
  --build-constraints requirements.lock --requirements requirements.lock
.venv/bin/uv pip uninstall --quiet --python .venv/bin/python ziglang
uv --quiet --no-deps --no-build-isolation --editable .

touch "$ready"
echo "set-up: done in $(($(date +%s) - started)) s"
