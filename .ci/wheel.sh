#!/usr/bin/env bash
# Build the wheel and install it alone, without extras, where no compiler is to be found: there it
# must simulate, to the same numbers as .venv, and name the extra for what it lacks.
set -euo pipefail
cd "$(dirname "$0")/.."
repository=$PWD
room=$(mktemp -d)
trap 'rm -rf "$room"' EXIT
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
unset PYTHONPATH PYTHONHOME
started=$(date +%s)

# What set-up has compiled (build/core) is taken again.
.venv/bin/python -c "from scikit_build_core.build import build_wheel; build_wheel('$room')" \
  >"$room/log" 2>&1 || { cat "$room/log" >&2; exit 1; }
built=$(date +%s)

# The versions are those of the lock; nothing is built, whatever the cache holds.
.venv/bin/uv venv --quiet --python .venv/bin/python "$room/venv"
env PATH="$room/venv/bin" "$repository/.venv/bin/uv" pip install --quiet --no-build \
  --python "$room/venv/bin/python" --constraints requirements.lock "$room"/*.whl
echo "wheel: $(du -k "$room"/*.whl | cut -f 1) kB, built in $((built - started)) s;" \
  "installed in $(($(date +%s) - built)) s, $(du -sm "$room/venv" | cut -f 1) MB:" \
  "$(.venv/bin/uv pip list --quiet --format freeze --python "$room/venv/bin/python" | wc -l) packages"

simulated='
import disorder_landscape as dl
wire = dl.Nanowire([0.3 * (-1) ** (n // 7) for n in range(300)], alpha=8.0)
G = dl.conductance(wire, mu=0.2, B=[0.2, 0.6], bias=[-0.02, 0.0], temperature=0.05)
print([[f"{x:.10f}" for x in G[name].values.ravel()] for name in sorted(G)])
'
expected=$(.venv/bin/python -c "$simulated")

cd "$room" # where there is no source
in_there() { env PATH="$room/venv/bin" "$@"; }
fail() { echo "wheel: $*" >&2; exit 1; }

if in_there sh -c true 2>/dev/null; then fail "there is more on PATH than the environment's own"; fi
got=$(in_there python -c "$simulated")
[ "$got" = "$expected" ] || fail "it simulates $got instead of $expected"
in_there landscape simulate --help >/dev/null
in_there landscape simulate --seed 1 --B 0:0.8:5 --bias 0 -o wire.nc
in_there landscape status --config "$repository/configs/smoke.toml" >/dev/null
says() { # EXTRA COMMAND...
  extra=$1
  shift
  code=0
  said=$(in_there landscape "$@" 2>&1) || code=$?
  [ "$code" = 2 ] && [[ $said == *" is missing: pip install 'disorder-landscape[$extra]'" ]] \
    || fail "landscape $* must name the extra $extra, but says (exit code $code): $said"
}
says kwant simulate --seed 1 --B 0.3 --bias 0 --solver kwant -o other.nc
says figures simulate --seed 1 --B 0.3 --bias 0 --plot wire.png -o other.nc
says learning train --config "$repository/configs/smoke.toml"
says inference infer wire.nc --model "$repository/data_small/models/ten_components" -o out.nc
in_there python -X importtime -c "import disorder_landscape" 2>&1 \
  | awk -F '|' 'END { printf "wheel: import disorder_landscape takes %.2f s\n", $2 / 1e6 }'
echo "wheel: all is well, after $(($(date +%s) - started)) s"
