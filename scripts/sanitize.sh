#!/bin/sh
# Run tests with a core that stops at the first bad access or undefined operation.
#
#   scripts/sanitize.sh TEST...
#
# It is installed in an environment of its own, build/sanitize/venv, which borrows the packages of
# .venv but does not see the core there, nor do the processes that a test starts.
set -eu
cxx=${CXX:-g++}
for library in asan ubsan stdc++; do
  path=$($cxx -print-file-name=lib$library.so 2>/dev/null) || path=
  case $path in
    /*) preload="${preload-} $path" ;;
    *) echo "sanitize: $cxx has no lib$library.so: apt-get install g++" >&2; exit 1 ;;
  esac
done

own=build/sanitize/venv
wheel=build/sanitize/wheel
[ -e $own/bin/python ] || .venv/bin/python -m venv --without-pip $own
purelib='import sysconfig; print(sysconfig.get_path("purelib"))'
.venv/bin/python -c "$purelib" >"$($own/bin/python -c "$purelib")/borrowed.pth"

rm -rf $wheel
mkdir -p $wheel
.venv/bin/python -c "
from scikit_build_core.build import build_editable
build_editable('$wheel', {
  'build-dir': 'build/sanitize/core', 'cmake.define.SANITIZE': 'ON', 'install.strip': 'false'
})" >build/sanitize/log 2>&1 || {
  cat build/sanitize/log >&2
  echo "sanitize: the core could not be built; why is above" >&2
  exit 1
}
.venv/bin/uv pip install --quiet --python $own/bin/python --no-cache --no-deps --reinstall $wheel/*.whl

# Python is not made for it: the sanitizers and what throws must be there before Python is, and
# Python's own memory, which it never returns, is no leak.  The sanitizers write past sys.stderr and
# end the process: what they say would be lost where pytest had taken the descriptors.
LD_PRELOAD=${preload# } ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=print_stacktrace=1 \
  $own/bin/python -m pytest --capture=sys "$@"
