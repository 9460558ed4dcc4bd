#!/bin/sh
# Compile core/c_interface.h to WebAssembly with Zig's compiler.
#
#   scripts/wasm.sh WASM
#
# The module needs SIMD of 128 bits, which browsers have had since 2021 (Safari since 2023), and no
# imports.  It has no exceptions, as the core throws none, and never ends: what is static stays.
set -eu
wasm=$1
if ! .venv/bin/python -c 'import ziglang' 2>/dev/null; then
  echo "wasm: Zig's compiler is fetched, once"
  .venv/bin/uv pip install --quiet --python .venv/bin/python \
    --require-hashes --requirements requirements-zig.lock
fi
exports=$(sed -n 's/^NANOWIRE_API.*\(nanowire_[a-z_]*\)(.*/-Wl,--export=\1/p' core/c_interface.h)
mkdir -p "$(dirname "$wasm")"
.venv/bin/python -m ziglang c++ -target wasm32-wasi -mexec-model=reactor -msimd128 \
  -std=c++20 -O3 -ffp-contract=off -fno-math-errno -fvisibility=hidden \
  -fno-exceptions -fno-rtti -fno-c++-static-destructors \
  -Wall -Wextra -Wpedantic -Werror -Wno-unknown-pragmas \
  -s -Wl,-z,stack-size=1048576 $exports \
  -I core core/c_interface.cpp -o "$wasm"
echo "$wasm: $(($(wc -c <"$wasm") / 1000)) kB"
