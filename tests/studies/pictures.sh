#!/usr/bin/env bash
# Ray traced truth beside what loden_walk draws in the three modes: near, far and magnified (eight pixels a
# texel) under one light, and near in the light of sky.hdr from all around.
# usage: pictures.sh BIN OUT TILE SURFACE.loden LOD.loden FUSED.loden
# Writes OUT/TILE-<camera>-<mode>.png, OUT/TILE.png (rows near, far; columns truth, surface, lod, fused), one
# such row each in OUT/TILE-magnified.png and OUT/TILE-sky.png, and prints one Markdown table row per mode and
# camera. Rows "fused, 4" are of pictures of twice the size, each pixel the mean of 2 x 2 of theirs in linear
# light, as temporal antialiasing or supersampling would give.
set -euo pipefail
readonly bin=$1 out=$2 tile=$3
readonly -A assets=([surface]=$4 [lod]=$5 [fused]=$6)
readonly size=320x160 twice=640x320
here=$(dirname "${BASH_SOURCE[0]}")
mkdir -p "$out"
if [[ ! -x $bin/picture_grid ]]; then cmake --build "$(dirname "$bin")" --target picture_grid >&2; fi

# row CAMERA MODE TRUTH PICTURE
row() {
  local difference psnr flip
  difference=$("$bin/loden" -q compare "$3" "$4")
  psnr=$(sed -n 's/.*PSNR \([^ ]*\) dB.*/\1/p' <<<"$difference")
  flip=$(sed -n 's/.*FLIP mean \([^, ]*\).*/\1/p' <<<"$difference")
  printf '| %s | %s | %s | %s | %.3f |\n' "$tile" "$1" "$2" "$psnr" "$flip"
}

pictures=()
for camera in near far magnified sky; do
  light=(--light 45,60) view=$camera
  if [[ $camera == sky ]]; then light=(--environment "$here/sky.hdr") view=near; fi
  common=(--surface plane --camera "$here/cameras/$view.json" "${light[@]}" --size "$size")
  truth=$out/$tile-$camera-truth.png
  "$bin/loden" -q trace "builtin:$tile" -o "$truth" "${common[@]}" --spp 256 >&2
  pictures+=("$truth")
  for mode in surface lod fused; do
    capture=$out/$tile-$camera-$mode
    "$bin/loden_walk" --asset "${assets[$mode]}" "${common[@]}" --headless --frames 1 --capture \
      "$capture" -q >&2
    picture=$(find "$capture" -name '*.png' -print -quit)
    pictures+=("$picture")
    row "$camera" "$mode" "$truth" "$picture"
  done
  if [[ $camera == sky ]]; then continue; fi
  capture=$out/$tile-$camera-fused-4
  "$bin/loden_walk" --asset "${assets[fused]}" "${common[@]/$size/$twice}" --headless --frames 1 --capture \
    "$capture" -q >&2
  "$bin/picture_grid" --halve "$capture.png" "$(find "$capture" -name '*.png' -print -quit)"
  row "$camera" "fused, 4" "$truth" "$capture.png"
done
"$bin/picture_grid" "$out/$tile.png" 4 "${pictures[@]:0:8}"
"$bin/picture_grid" "$out/$tile-magnified.png" 4 "${pictures[@]:8:4}"
"$bin/picture_grid" "$out/$tile-sky.png" 4 "${pictures[@]:12}"
