#!/bin/sh
# Print a Python that set-up can use, or else one line for each thing that is missing, with the
# Debian package that brings it.  PYTHON, where set, is the only one considered.
set -eu
packages=
missing() {
  echo "set-up: $1 is missing: apt-get install $2" >&2
  packages="$packages $2"
}

suitable() {
  "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' 2>/dev/null
}
if [ -n "${PYTHON-}" ]; then set -- "$PYTHON"; else set -- python3 python3.11 python3.12 python3.13; fi
first=$1
while [ $# -gt 0 ] && ! suitable "$1"; do shift; done
if [ $# -eq 0 ]; then
  found=$("$first" --version 2>/dev/null) || found="not there"
  echo "set-up: Python 3.11, 3.12 or 3.13 is needed, but $first is $found:" \
    "apt-get install python3 (Debian 12 or 13), or name one: make PYTHON=/path/to/python3.11" >&2
  exit 1
fi
python=$1

# Debian's packages are python3-venv for python3, but python3.12-venv for python3.12.
debian=$(basename "$python" | sed 's/^python$/python3/')
"$python" -c 'import ensurepip, venv' 2>/dev/null || missing "Python's venv module" "$debian-venv"

include=$("$python" -c 'import sysconfig; print(sysconfig.get_path("include"))')
[ -e "$include/Python.h" ] || missing "Python's header Python.h" "$debian-dev"

cc=${CC:-$("$python" -c 'import sysconfig; print(sysconfig.get_config_var("CC") or "gcc")')}
if ! command -v "${cc%% *}" >/dev/null; then
  missing "the C compiler ${cc%% *}" "gcc libc6-dev"
elif ! echo '#include <stdlib.h>' | $cc -fsyntax-only -x c - 2>/dev/null; then
  missing "the C library's header stdlib.h" libc6-dev
fi

[ -z "$packages" ] || exit 1
echo "$python"
