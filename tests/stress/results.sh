#!/usr/bin/env bash
# The stress tests at full length, and RESULTS.md from the numbers that they note.
#   results.sh BIN RESULTS LOG [assemble]    BIN: folder of the programs; LOG: where their output goes;
#                                            assemble: from the numbers of the last run
set -euo pipefail
readonly BIN=$1 RESULTS=$2 LOG=$3
export LODEN_STRESS_LONG=1 LODEN_STRESS_RECORD=$LOG.rows

run() {
  local program status=0
  : >"$LOG"
  : >"$LODEN_STRESS_RECORD"
  # Software rendering, headless, as in the tests.
  export GALLIVM_PERF=${GALLIVM_PERF-no_aos_sampling} LIBGL_ALWAYS_SOFTWARE=1 EGL_PLATFORM=surfaceless
  for program in stress_material stress_importer stress_gl; do
    [[ ! -x $BIN/$program ]] || "$BIN/$program" >>"$LOG" 2>&1 || status=1
  done
  if [[ -x $BIN/cli_loden ]]; then
    if LODEN_KILL_MOMENTS=200 "$BIN/cli_loden" --gtest_filter='Kill.*' >>"$LOG" 2>&1; then
      for program in bake cook pack; do
        printf '| %s killed at 200 moments: files neither old, new nor absent | 0 | 0 | `%s` |\n' "$program" \
          "LODEN_KILL_MOMENTS=200 cli_loden --gtest_filter=Kill.${program^}*"
      done >>"$LODEN_STRESS_RECORD"
    else
      status=1
    fi
  fi
  "${BASH_SOURCE[0]%/*}/../bytes/compilers.sh" >>"$LOG" 2>&1 || status=1
  ((status == 0)) || { grep -h '^\[  FAILED' "$LOG" | sort -u >&2; exit 1; }
  [[ ! -x $BIN/stress_time_error ]] ||
    "$BIN/stress_time_error" "${RESULTS%/*}/time-error.svg" >"$LOG.times"
}
[[ ${4-} == assemble ]] || run

title() {
  case $1 in
    StressDirections) echo "Directions" ;;
    StressCoordinates) echo "Coordinates" ;;
    StressLevels) echo "Levels of detail" ;;
    StressGl) echo "Shaders against the evaluator at the same edges" ;;
    StressPrecision) echo "Precision: double, float, half, 8 bit" ;;
    StressRays) echo "Rays" ;;
    StressShadows) echo "Cast shadows by look-up" ;;
    StressFits) echo "Fits" ;;
    StressPhysics) echo "Physics" ;;
    Kill) echo "Kills" ;;
    StressSoak) echo "Materials that come and go" ;;
    *) echo "$1" ;;
  esac
}

{
  cat <<'TEXT'
# Numerical stability, measured

`./loden.sh stress` runs the tests below at full length and writes this page; `ctest -L stress` runs a quick
part of each, with the same bounds. Each row gives a measured number, the bound that the test requires, and
the command that measures it. Commands are programs of the build's `bin` folder, which run at full length if
`LODEN_STRESS_LONG` is set. Expected values are closed forms, formulas written out in double in the test,
certified values, or rays traced through the tile. What follows from the tables, as long as all rows meet
their bounds:

- Every direction, coordinate and level of detail gives a finite value that is not negative, in the evaluator
  and in the shaders, and there are no steps over directions and levels.
- Float agrees with double, and the shaders with the evaluator, to 1e-3 of white.
- Rays do not pass through geometry images and meshes, and cast shadows have neither leaks nor acne beyond one
  in a thousand points.
- Fits reach at least 6 digits of certified parameters, at any brightness of their input.
- Surfaces do not reflect more light than they receive, except white dielectrics (up to 7 %).
- Assets have the same bytes for any number of threads.
- Killed programs leave whole files, and streaming keeps its byte budget in every frame.
TEXT
  suite=
  while IFS= read -r row; do
    this=${row##*--gtest_filter=}
    this=${this%%.*}
    if [[ $this != "$suite" ]]; then
      suite=$this
      printf '\n## %s\n\n| what | measured | must be | command |\n|---|---|---|---|\n' "$(title "$suite")"
    fi
    printf '%s\n' "$row"
  done <"$LODEN_STRESS_RECORD"
  if [[ -s $LOG.times ]]; then
    cat <<'TEXT'

## Time against error

`stress_time_error tests/stress/time-error.svg` draws 160 x 160 pixels with all settings in turns, and takes
the least time of 15 rounds. Times are relative to the 8-bit shader, the 8-bit evaluator and the plain map of
each block. Shaders run on llvmpipe (Mesa's software renderer) with all cores, the evaluator on one core.
Bands are compared with their definition in double, look-ups and shadows with the traced tile (16 samples per
pixel; the error of the best rows is aliasing).

| what | setting | time | PSNR, dB |
|---|---|---|---|
TEXT
    cat "$LOG.times"
    printf '\n![Time against error](time-error.svg)\n'
  fi
} >"$RESULTS.new"
mv "$RESULTS.new" "$RESULTS"
