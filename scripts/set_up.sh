#!/bin/sh
# Make .venv: what requirements.lock lists, nothing unhashed, and the package itself, editable, with
# its compiled core.
#
#   scripts/set_up.sh READY
#
# READY, a file in .venv, is made last.  Another one, `locked`, says that all is there which comes
# from the locks: where it is, only the core is compiled, and of that only what has changed.  Without
# one, .venv is the rest of an interrupted set-up.
set -eu
ready=$1
started=$(date +%s)

# Where two makes start at once, the second waits here and finds the work done.
exec 9<requirements.lock
if command -v flock >/dev/null; then flock 9; fi
[ ! -e "$ready" ] || exit 0

locked=.venv/locked-$(cat requirements*.lock scripts/set_up.sh | sha256sum | cut -c 1-12)
cores=$(getconf _NPROCESSORS_ONLN)
wheel=build/core/wheel
log=build/core/log

# uv keeps what it fetches at home; where that cannot be written, it is kept here.
cache=${UV_CACHE_DIR:-${XDG_CACHE_HOME:-${HOME:-/nowhere}/.cache}/uv}
if ! mkdir -p "$cache" 2>/dev/null || [ ! -w "$cache" ]; then export UV_CACHE_DIR="$PWD/build/cache/uv"; fi
uv() { .venv/bin/uv pip install --python .venv/bin/python "$@"; }
lock() { uv --quiet --require-hashes --requirements "$1"; }

# Debian's gcc comes without g++, and an old one knows no C++20.  Zig's compiler does it then.
compiler() {
  default=$(.venv/bin/python -c 'import sysconfig; print(sysconfig.get_config_var("CXX") or "g++")')
  for cxx in "${CXX:-$default}" g++ clang++; do
    if command -v "${cxx%% *}" >/dev/null \
      && echo '#include <span>' | $cxx -std=c++20 -fsyntax-only -x c++ - 2>/dev/null; then
      export CXX="$cxx"
      [ "$cxx" = "$default" ] || export LDCXXSHARED="$cxx -shared"
      return
    fi
  done
  case $PWD in
    *[[:space:]]*)
      echo "set-up: there is no C++20 compiler (apt-get install g++), and Zig's needs a path without spaces" >&2
      exit 1 ;;
  esac
  if ! .venv/bin/python -c 'import ziglang' 2>/dev/null; then
    echo "set-up: there is no C++20 compiler (g++ or clang++), so Zig's is fetched"
    lock requirements-zig.lock
  fi
  export CXX="$PWD/scripts/zig-c++" LDCXXSHARED="$PWD/scripts/zig-c++ -shared"
}

# An editable wheel of the package, by what pyproject.toml names as its build backend.
compile_core() {
  rm -rf "$wheel"
  mkdir -p "$wheel"
  CMAKE_BUILD_PARALLEL_LEVEL=$1 .venv/bin/python -c \
    "from scikit_build_core.build import build_editable; build_editable('$wheel')" >"$log" 2>&1
}
install_core() {
  uv --quiet --no-cache --no-deps --reinstall "$wheel"/*.whl
}
core_failed() {
  cat "$log" >&2
  echo "set-up: the compiled core (core/, CMakeLists.txt) could not be built; why is above" >&2
  exit 1
}

if [ -e "$locked" ]; then
  echo "set-up: compiling what has changed in core/"
  compiler
  compile_core "$cores" || core_failed
else
  python=$(sh scripts/prerequisites.sh)
  echo "set-up: making .venv with $("$python" --version), once; about 3 minutes, of which Kwant takes 1 or 2"

  ls .venv/locked-* >/dev/null 2>&1 || rm -rf .venv
  rm -rf .venv/ready-* .venv/locked-* build/core
  [ -d .venv ] || "$python" -m venv .venv

  .venv/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements-uv.lock
  lock requirements-core.lock
  compiler

  # Kwant's build keeps one processor busy; the core takes those that it leaves.
  compile_core $((cores > 2 ? cores - 1 : 1)) &
  core=$!
  trap 'kill $core 2>/dev/null || :' EXIT

  # The lock also pins, with hashes, what Kwant and Tinyarray are built with.
  uv --require-hashes --require-build-hashes --preview-features build-dependency-hashes \
    --build-constraints requirements.lock --requirements requirements.lock
  touch "$locked"
  wait $core || core_failed
  trap - EXIT
  # It is large.  Only who changes the core fetches it once more, and keeps it.
  .venv/bin/uv pip uninstall --quiet --python .venv/bin/python ziglang
fi

rm -f .venv/ready-*
install_core
touch "$ready"
echo "set-up: done in $(($(date +%s) - started)) s"
