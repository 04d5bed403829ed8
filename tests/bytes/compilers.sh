#!/usr/bin/env bash
# Reads the same assets, builds their atlases and evaluates them with what several compilers make of
# Loden::material at several levels of optimization, and for WebAssembly; compares byte for byte. What differs
# is measured; README.md beside this file says what may, and why. Exit code 1 if something else does.
# usage: compilers.sh [FOLDER]     FOLDER: for what is built, kept; default: a new one, removed at the end
# Compilers that are not installed are left out. For WebAssembly: Debian's clang-16, lld-16, node,
# libc++-16-dev-wasm32, libc++abi-16-dev-wasm32, libclang-rt-16-dev-wasm32 and wasi-libc; WASM_ROOT: where
# they were unpacked, if they are not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
if (($# > 0)); then
  mkdir -p "$1"
  out=$(cd "$1" && pwd)
else
  out=$(mktemp -d)
  trap 'rm -rf "$out"' EXIT
fi
readonly root=${WASM_ROOT-}
mapfile -t assets < <(ls "$PWD"/tests/fuzz/corpus/asset_fuzz/*_stored.loden)
mapfile -t sources < <(find material/base material/model material/eval material/asset -name '*.cpp' | sort
                       echo tests/bytes/digest.cpp)

# compile FOLDER COMPILER FLAG...: objects of all sources.
compile() {
  local folder=$1
  shift
  mkdir -p "$folder"
  printf '%s\n' "${sources[@]}" | xargs -P "${LODEN_JOBS:-2}" -I{} bash -c '
    object=$0/$(tr / _ <<<"$1").o
    [[ $object -nt $1 ]] || "${@:2}" -c "$1" -o "$object"' "$folder" {} "$@"
}

# native NAME COMPILER FLAG...: the values and digests of one build.
native() {
  local name=$1 compiler=$2
  shift 2
  command -v "$compiler" >/dev/null || { echo "$name: $compiler is not installed" >&2; return; }
  compile "$out/$name" "$compiler" -std=c++20 -I. -ffp-contract=off "$@"
  "$compiler" "$out/$name"/*.o -o "$out/$name/digest" -lzstd -lxxhash -pthread
  "$out/$name/digest" "$out/$name.values" "${assets[@]}" >"$out/$name.txt"
}

# The same for WebAssembly, run by node. The assets are stored without compression: zstd is not linked.
webassembly() {
  local llvm=$root/usr/lib/llvm-16 libc=$root/usr/include/wasm32-wasi
  if [[ ! -x $llvm/bin/clang++ || ! -e $llvm/include/wasm32-wasi/c++/v1/vector || ! -e $libc/stdio.h ]] ||
    ! command -v node >/dev/null; then
    echo "wasm: clang-16, its WebAssembly libraries or node are not installed" >&2
    return
  fi
  [[ -z $root ]] || export LD_LIBRARY_PATH=$root/usr/lib/x86_64-linux-gnu:$llvm/lib
  mkdir -p "$out/headers"
  ln -sfn /usr/include/{glm,zstd.h,zstd_errors.h,xxhash.h,xxh3.h} "$out/headers"
  compile "$out/wasm" "$llvm/bin/clang++" --target=wasm32-wasi -std=c++20 -O3 -ffp-contract=off \
    -DXXH_INLINE_ALL -nostdinc++ -nostdlibinc -isystem "$llvm/include/wasm32-wasi/c++/v1" -isystem "$libc" \
    -isystem "$out/headers" -I.
  local lib=$root/usr/lib/wasm32-wasi
  "$llvm/bin/wasm-ld" "$lib/crt1-command.o" "$out"/wasm/*.o -L"$lib" \
    -L"$llvm/lib/wasm32-wasi" -lc++ -lc++abi -lc \
    "$llvm"/lib/clang/16*/lib/wasi/libclang_rt.builtins-wasm32.a --allow-undefined \
    -z stack-size=1048576 -o "$out/wasm/digest.wasm"
  cat >"$out/wasm/run.mjs" <<'JS'
import { readFile } from "node:fs/promises";
import { WASI } from "node:wasi";
const [program, ...args] = process.argv.slice(2);
const wasi = new WASI({ version: "preview1", args: ["digest", ...args], preopens: { "/": "/" } });
const module = await WebAssembly.compile(await readFile(program));
const env = {};
for (const { module: from, name } of WebAssembly.Module.imports(module))
  if (from === "env") env[name] = () => { throw new Error(name + " is not linked"); };
process.exitCode = wasi.start(await WebAssembly.instantiate(module, { ...wasi.getImportObject(), env }));
JS
  node --no-warnings "$out/wasm/run.mjs" "$out/wasm/digest.wasm" "$out/wasm.values" "${assets[@]}" \
    >"$out/wasm.txt"
}

native gcc-O3 g++ -O3 -DNDEBUG
for level in O0 O2; do native "gcc-$level" g++ "-$level"; done
for level in O0 O3; do native "clang-$level" clang++ "-$level"; done
webassembly

python3 - "$out" <<'PY'
import glob, os, struct, sys
out = sys.argv[1]
def read(name):
    data = open(f"{out}/{name}.values", "rb").read()
    return open(f"{out}/{name}.txt").read().splitlines(), struct.unpack(f"<{len(data) // 8}d", data)
names = sorted(os.path.basename(f)[:-4] for f in glob.glob(out + "/*.txt"))
lines, values = read("gcc-O3")
print(f"gcc-O3: {len(lines)} digests, {len(values)} values")
bad = False
for name in names:
    if name == "gcc-O3":
        continue
    its_lines, its_values = read(name)
    different = [a.rsplit(" ", 1)[0] for a, b in zip(lines, its_lines) if a != b]
    count = sum(a != b for a, b in zip(values, its_values))
    most = max(abs(a - b) for a, b in zip(values, its_values))
    print(f"{name}: {len(different)} digests differ, {count} values, by {most:.3g} at most")
    # A WebAssembly program has another library of mathematics: README.md.
    wrong = [line for line in different if name != "wasm" or not line.endswith(" double")]
    for line in wrong:
        print("  ", line)
    bad |= bool(wrong) or len(lines) != len(its_lines) or most > 1e-12
sys.exit(bad)
PY
