#!/usr/bin/env bash
# Compiles the core of Loden::material, which is all of it but material/system, for WebAssembly. Needs
# Debian's clang-16, libc++-16-dev-wasm32 and wasi-libc; without them it exits with 77, which ctest counts as
# skipped.
# usage: wasm_core.sh, from anywhere
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
readonly libcxx=/usr/lib/llvm-16/include/wasm32-wasi/c++/v1 libc=/usr/include/wasm32-wasi
if ! command -v clang++-16 >/dev/null || [[ ! -e $libcxx/vector || ! -e $libc/stdio.h ]]; then
  echo "skipped: clang-16, libc++-16-dev-wasm32 and wasi-libc are not installed"
  exit 77
fi

# The host's headers of libraries that are headers alone, or only linked later; not those of its C library.
headers=$(mktemp -d)
trap 'rm -rf "$headers"' EXIT
ln -s /usr/include/{glm,zstd.h,zstd_errors.h,xxhash.h,xxh3.h} "$headers"

flags=(--target=wasm32-wasi -std=c++20 -fsyntax-only -nostdinc++ -nostdlibinc
  -isystem "$libcxx" -isystem "$libc" -isystem "$headers" -I.)
find material/base material/model material/eval material/asset -name '*.cpp' -print0 |
  xargs -0 -P 2 -n 1 clang++-16 "${flags[@]}"
echo "the core of Loden::material compiles for wasm32-wasi"
