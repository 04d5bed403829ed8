#!/usr/bin/env bash
# The pictures of FBTF figures 9, 10, 11 and 13, each of all tiles, from what the studies have written.
# usage: figures.sh BIN PICTURES OUT [SIZE]
# Reads PICTURES/<study>-<tile>-... of `loden study ... --pictures PICTURES` at SIZE (64); writes
# OUT/<study>.png, a row per tile: button, isba, pulli, sponge.
set -euo pipefail
readonly bin=$1 pictures=$2 out=$3 size=${4:-64}
readonly tiles=(button isba pulli sponge)
mkdir -p "$out"

# grid STUDY SUFFIX...: one column per suffix.
grid() {
  local study=$1 tile suffix cells=()
  shift
  for tile in "${tiles[@]}"; do
    for suffix in "$@"; do cells+=("$pictures/$study-$tile-$suffix.png"); done
  done
  "$bin/picture_grid" "$out/$study.png" "$#" "${cells[@]}"
}

readonly flat=$((2 * size))-linear
grid flat-reconstruction $flat-{flat,vdim,reconstructed,reference,difference}
grid vdim-interpolation latlong-{8x32,16x16}-paper cooked-{fast,default}
grid view-coherence btf flat-filled flat-filled-nearest-view flat-visible
grid abrdf-size 1-{btf-texel,flat-push-pull-point,flat-nearest-view-point} \
      2-{btf-texel,flat-push-pull-texel,flat-nearest-view-texel}
