#!/usr/bin/env bash
# Loden's one entry: installs what is missing (Debian 12), configures, builds what the verb needs, runs it.
# Output of every step goes to build/logs/; the screen gets one line per step, live on a terminal.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

readonly BUILD=build/release
readonly LOGS=build/logs
readonly BIN=$BUILD/bin
readonly TILES=(button isba pulli sponge)
readonly PACKAGES=(
  build-essential ca-certificates ccache clang-format cmake ninja-build pkg-config libceres-dev libcli11-dev
  libegl-dev libeigen3-dev libembree-dev libepoxy-dev libfmt-dev libglfw3-dev libglm-dev libgtest-dev
  libimgui-dev libmeshoptimizer-dev libopenimageio-dev libosd-dev libpng-dev libstb-dev libtbb-dev
  libtinygltf-dev libturbojpeg0-dev libvulkan-dev libwebp-dev libxxhash-dev libzstd-dev nlohmann-json3-dev
  libegl-mesa0 libgl1-mesa-dri libgles2 glslang-tools mesa-vulkan-drivers python3 xdotool xvfb zstd
)
# llvmpipe, if that draws: 8-bit textures at full precision, in every verb alike.
export GALLIVM_PERF=${GALLIVM_PERF-no_aos_sampling}

usage() {
  cat <<'TEXT'
usage: ./loden.sh VERB

  demo      bake the four builtin tiles, cook them, walk through the gallery; ends by naming a picture, and
            how to walk by hand. 12 min, 6 of them compiling; 1 GB
  test      build everything and run all tests. Some 30 min, half a GB
  bench     build and run the benchmarks, plots below out/bench. Some 60 min more than the build
  stress    the tests of numerical stability, of kills and of long runs at full length; writes
            tests/stress/RESULTS.md
  studies   run the papers' studies; tables and JSON below out/studies. Hours, 3 GB; studies NAME TILE runs
            one, of one tile: 1 to 3 min for most
  pictures  ray traced truth beside the three modes, near, far and magnified: PSNR, FLIP and one picture.
            10 min more than the demo
  build     build the libraries, the tools and the tests. 10 min, 0.2 GB
  format    format the code and wrap the text, as the tests want it
  clean     remove build/ and out/
  help      this text

Times are those of two cores.
The first run on a fresh Debian 12 installs packages (as root, or with sudo).
Environment: LODEN_JOBS=N, parallel compilations (default: by cores and memory).
TEXT
}

say() { printf '%s\n' "$*" >&2; }
die() { say "loden.sh: $*"; exit 1; }
is_terminal() { [[ -t 2 && ${TERM:-dumb} != dumb ]]; }
# Overwrites the current line on a terminal; silent otherwise.
live() { if is_terminal; then printf '\r\033[K%s' "$*" >&2; fi; }
finish() { if is_terminal; then printf '\r\033[K' >&2; fi; say "$*"; }

# --- steps -------------------------------------------------------------------------------------------------

# step LABEL LOG READER COMMAND...: runs the command, output to the log through READER; on failure shows the
# end of the log and stops with the command's exit status.
step() {
  local label=$1 log=$LOGS/$2.log reader=$3 start=$SECONDS status=0
  shift 3
  mkdir -p "$LOGS"
  is_terminal || say "$label ..."
  "$@" 2>&1 | "$reader" "$label" "$log" || status=${PIPESTATUS[0]}
  if ((status != 0)); then
    finish "$label: failed with exit status $status; the end of $log:"
    tail -n 30 "$log" >&2
    exit "$status"
  fi
  finish "$label: done in $((SECONDS - start)) s"
}

# Readers: copy standard input to the log ($2) and show how far it is.
read_plain() {
  live "$1 ..."
  cat >"$2"
}
read_ninja() {  # "[12/140] Building ..."
  local line built all told=0
  while IFS= read -r line; do
    printf '%s\n' "$line"
    [[ $line =~ ^\[([0-9]+)/([0-9]+)\] ]] || continue
    built=${BASH_REMATCH[1]} all=${BASH_REMATCH[2]}
    live "$1: $built of $all"
    if ! is_terminal && ((built * 5 / all > told)); then
      told=$((built * 5 / all))
      say "$1: $built of $all"
    fi
  done >"$2"
}
read_apt() {  # "pmstatus:libglm-dev:42.5:Unpacking ..."
  local line
  while IFS= read -r line; do
    if [[ $line =~ ^(dl|pm)status:[^:]*:([0-9]+) ]]; then
      local doing=
      [[ ${BASH_REMATCH[1]} == dl ]] && doing='fetching, '
      live "$1: $doing${BASH_REMATCH[2]} %"
    else
      printf '%s\n' "$line"
    fi
  done >"$2"
}

# --- packages and build ---------------------------------------------------------------------------

missing_packages() {
  local installed package
  installed=" $(dpkg-query -W -f '${db:Status-Status} ${Package}\n' "${PACKAGES[@]}" 2>/dev/null |
    sed -n 's/^installed //p' | tr '\n' ' ') "
  for package in "${PACKAGES[@]}"; do
    [[ $installed == *" $package "* ]] || printf '%s\n' "$package"
  done
}

install_packages() {
  if ! command -v dpkg-query >/dev/null; then
    say "not a Debian system: expecting these packages' contents to be installed: ${PACKAGES[*]}"
    return
  fi
  local missing root=()
  mapfile -t missing < <(missing_packages || true)
  ((${#missing[@]})) || return 0
  if [[ $(id -u) != 0 ]]; then
    command -v sudo >/dev/null ||
      die "missing packages; as root: apt-get install --no-install-recommends ${missing[*]}"
    sudo -v
    root=(sudo)
  fi
  # Descriptor 3 is opened behind sudo, which closes all but the first three; apt closes its own for the
  # packages' scripts.
  local apt=("${root[@]}" env DEBIAN_FRONTEND=noninteractive sh -c 'exec apt-get -y -q "$@" 3>&1' apt
    -o DPkg::Lock::Timeout=120 -o APT::Status-Fd=3)
  step "package lists" apt-update read_apt "${apt[@]}" update
  step "installing ${#missing[@]} packages" apt-install read_apt \
    "${apt[@]}" install --no-install-recommends "${missing[@]}"
}

# Parallel compilations: one per core, but 1.5 GB of free memory for each.
jobs_here() {
  local cores available
  cores=$(nproc)
  available=$(awk '/^MemAvailable/ {print int($2 / 1500000)}' /proc/meminfo)
  ((available >= 1)) || available=1
  echo "${LODEN_JOBS:-$((cores < available ? cores : available))}"
}

# build TARGET...
build() {
  install_packages
  if [[ ! -f $BUILD/build.ninja ]]; then
    step "configuring" configure read_plain cmake --preset release
  fi
  step "building $*" build read_ninja env NINJA_STATUS='[%f/%t] ' \
    cmake --build "$BUILD" --parallel "$(jobs_here)" --target "$@"
}

# --- demo -----------------------------------------------------------------------------------------

# First 12 hex digits of the hash of the tool and the given words: names what the tool makes of them.
key() { { cat "$BIN/loden"; printf '%s\0' "$@"; } | sha256sum | cut -c1-12; }

# tool WHAT COMMAND...: runs a tool that shows its own progress; its data goes to the log.
tool() {
  local what=$1 log=$LOGS/tools.log
  shift
  say "$what"
  printf '+ %s\n' "$*" >>"$log"
  "$@" >>"$log" || die "$what: exit status $?; command: $*"
}

# bake_tile TILE: prints the folder. The tool goes on with an interrupted bake, keeps a finished one, and
# refuses one of another tile or version (exit status 2), which is then baked anew.
bake_tile() {
  local folder=out/bake/$1-64 command status=0
  command=("$BIN/loden" bake "builtin:$1" -o "$folder" --size 64 --directions bonn81)
  say "baking $1"
  printf '+ %s\n' "${command[*]} --resume" >>"$LOGS/tools.log"
  "${command[@]}" --resume >>"$LOGS/tools.log" || status=$?
  case $status in
    0) ;;
    2) tool "baking $1 anew" "${command[@]}" ;;
    *) die "baking $1: exit status $status; command: ${command[*]} --resume" ;;
  esac
  echo "$folder"
}

# cook_tile TILE FOLDER NAME OPTION...: prints the asset's path; cooks unless this tool cooked the same bake
# before.
cook_tile() {
  local tile=$1 folder=$2 name=$3 asset
  shift 3
  asset=out/assets/$tile-$name-$(key cook "$(<"$folder/bake.json")" "$@").loden
  if [[ ! -e $asset ]]; then
    mkdir -p out/assets
    tool "cooking $tile, $name" "$BIN/loden" cook "$folder" -o "$asset" "$@"
  fi
  echo "$asset"
}

verb_demo() {
  build loden loden_walk loden_gallery loden_rooms
  mkdir -p "$LOGS" out/demo/scene
  : >"$LOGS/tools.log"
  local tile baked asset scene=$BUILD/gallery/gallery.gltf packed=out/demo/scene/gallery.gltf
  for tile in "${TILES[@]}"; do
    baked=$(bake_tile "$tile")
    asset=$(cook_tile "$tile" "$baked" fused --mode fused)
    tool "packing $tile into the gallery" "$BIN/loden" pack "$scene" --material "$tile" --asset "$asset" \
      --scale 1,1 --fit-fallback -o "$packed"
    scene=$packed
  done
  walk "$packed" --size 800x600 --frames 60
  local rooms=out/demo/rooms/rooms.gltf from=$BUILD/rooms/rooms.gltf
  mkdir -p "${rooms%/*}"
  for tile in "${TILES[@]}"; do
    asset=$(cook_tile "$tile" "out/bake/$tile-64" fused --mode fused)
    tool "packing $tile into the rooms" "$BIN/loden" pack "$from" --material "$tile" --asset "$asset" \
      --period 5cm --fit-fallback -o "$rooms"
    from=$rooms
  done
  say "picture: $PWD/out/demo/contact_sheet.png"
  say "to walk by hand, through rooms full of these materials (H shows the keys):"
  say "  $PWD/$BIN/loden_walk $PWD/$rooms"
  say "with one of them on a scene of yours:"
  say "  $PWD/$BIN/loden_walk SCENE.glb --material NAME --asset $PWD/$asset --period 2cm"
}

# walk SCENE OPTION...: captures the scripted walk into out/demo, unless the same walk is there already.
walk() {
  local script=$BUILD/gallery/walk.json walked
  walked=$(cat "$BIN/loden_walk" "$script" "$(dirname "$1")"/* <(printf '%s\0' "$@") | sha256sum)
  [[ $walked == "$(cat out/demo/walked 2>/dev/null)" ]] && return
  rm -rf out/demo/frames out/demo/walked
  tool "walking through the gallery" "$BIN/loden_walk" "$@" --headless --script "$script" \
    --capture out/demo/frames --contact-sheet out/demo/contact_sheet.png --report out/demo/report.json
  echo "$walked" >out/demo/walked
}

# --- other verbs ----------------------------------------------------------------------------------

verb_build() { build all; }

verb_test() {
  build all
  ctest --test-dir "$BUILD" --output-on-failure --parallel 2
}

# The benchmarks are the binaries named bench_*. Those of tiles leave their rows as JSON, and plots of them.
verb_bench() {
  build all
  local bench found=0 out=out/bench options plot
  mkdir -p "$out"
  for bench in "$BIN"/bench_*; do
    [[ -x $bench ]] || continue
    found=1
    case ${bench##*/} in
      bench_time_error) options=(--lambda "-1,0,1,2,3,4" --json "$out/time-error.json") ;;
      bench_motion) options=(--tile pulli --json "$out/motion.json" --pictures "$out") ;;
      *) options=() ;;
    esac
    "$bench" "${options[@]}"
  done
  ((found)) || die "this version has no benchmarks"
  [[ -x $BIN/plot_benchmarks ]] || return 0
  "$BIN/plot_benchmarks" "$out" "$out/time-error.json" "$out/motion.json" >/dev/null
  if command -v rsvg-convert >/dev/null; then
    for plot in "$out"/*.svg; do rsvg-convert "$plot" -o "${plot%.svg}.png"; done
  fi
  say "plots and strips: $PWD/$out"
}

verb_stress() {
  build all
  mkdir -p "$LOGS"
  say "stress tests at full length; output in $LOGS/stress.log"
  tests/stress/results.sh "$BIN" tests/stress/RESULTS.md "$LOGS/stress.log"
  say "numbers: $PWD/tests/stress/RESULTS.md"
}

# verb_studies [NAME [TILE]]: one study, of one tile; or all.
verb_studies() {
  build loden bench_time_error picture_grid
  mkdir -p "$LOGS" out/studies
  local study names
  : >"$LOGS/tools.log"
  names=$("$BIN/loden" study --help | sed -n '/^Studies:/,$s/^  *\([a-z][a-z-]*\)  .*/\1/p')
  if (($# > 0)); then
    grep -qx -- "$1" <<<"$names" || die "there is no study $1; there are: ${names//$'\n'/, }"
    local out=out/studies/$1${2:+-$2}
    tool "study $1${2:+ of $2}" "$BIN/loden" study "$1" ${2:+--tile "$2"} --bakes out/studies/bakes \
      --json "$out.json" --csv "$out.csv" --pictures out/studies/pictures
    tail -n +2 "$LOGS/tools.log"
    say "JSON and CSV: $PWD/$out.json, $PWD/$out.csv"
    return
  fi
  for study in $names; do
    tool "study $study" "$BIN/loden" study "$study" --bakes out/studies/bakes \
      --json "out/studies/$study.json" \
      --csv "out/studies/$study.csv" --pictures out/studies/pictures
  done
  tool "figures" tests/studies/figures.sh "$BIN" out/studies/pictures out/studies
  say "tables, JSON and pictures: $PWD/out/studies, text in $LOGS/tools.log"
}

verb_pictures() {
  build loden loden_walk picture_grid
  mkdir -p "$LOGS" out/pictures
  : >"$LOGS/tools.log"
  local tile baked surface lod fused
  {
    echo '| tile | camera | mode | PSNR, dB | mean FLIP |'
    echo '|---|---|---|---|---|'
  } | tee out/pictures/table.md
  for tile in "${TILES[@]}"; do
    baked=$(bake_tile "$tile")
    surface=$(cook_tile "$tile" "$baked" surface --mode surface)
    lod=$(cook_tile "$tile" "$baked" lod --mode lod --preset seed)
    fused=$(cook_tile "$tile" "$baked" fused --mode fused)
    tests/studies/pictures.sh "$BIN" out/pictures "$tile" "$surface" "$lod" "$fused"
  done | tee -a out/pictures/table.md
  "$BIN/picture_grid" out/pictures/magnified.png 1 out/pictures/{button,isba,pulli,sponge}-magnified.png
  say "table: $PWD/out/pictures/table.md, pictures beside it"
}

verb_format() {
  install_packages
  python3 tests/style/style.py --fix
}

verb_clean() { rm -rf build out; }

case ${1:-help} in
  studies)
    (($# <= 3)) || die "studies takes a study and a tile, or nothing"
    verb_studies "${@:2}"
    ;;
  demo | test | bench | stress | pictures | build | format | clean)
    (($# == 1)) || die "the verb $1 takes no arguments"
    "verb_$1"
    ;;
  help | -h | --help) usage ;;
  *)
    usage >&2
    exit 1
    ;;
esac
