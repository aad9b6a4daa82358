#!/bin/sh
# consolidation.sh DIRECTORY: mps-consolidation against its exact solutions, on coarse grids.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"

value() { sed -n "s/^ *\"$2\": \([^,]*\),*$/\1/p" "$work/$1/summary.json"; }
within() { # within CASE ERROR SETTLEMENT: of the pressures, and of the settlement over the exact one
  awk -v u="$(value "$1" pressure_error)" -v s="$(value "$1" settlement)" \
    -v e="$(value "$1" settlement_exact)" -v most="$2" -v off="$3" 'BEGIN {
      exit !(u > 0 && u < most && (off == 0 || (s > (1 - off) * e && s < (1 + off) * e))) }' ||
    fail "$1: pressures off by $(value "$1" pressure_error), settlement $(value "$1" settlement)"
}
run() {
  case=$1
  shift
  "$programs/mps-consolidation" --case "$case" --threads 1 --out "$work/$case" "$@" >"$work/log"
}
programs=$1
run terzaghi --cell 0.1 --water-stiffness 50 --times 0.1,0.5 --poisson 0.3
within terzaghi 0.015 0.02
[ "$(head -1 "$work/terzaghi/profile.csv")" = "T,depth/H,u/u0,exact" ] || fail "columns of profile.csv"
run large --cell 0.05 --water-stiffness 50 --times 0.2 --load 300kPa
within large 0.03 0.02
run mandel --cell 0.2 --water-stiffness 50 --times 0.05,0.2
within mandel 0.03 0
run cryer --cell 0.125 --water-stiffness 20 --times 0.05,0.1 --poisson 0
within cryer 0.1 0.1
run mcc --cell 0.125 --water-stiffness 20 --times 0.2,0.5
within mcc 0.05 0.02
[ "$(value mcc left_kg)" != "$(value mcc drained_kg)" ] || fail "mcc: left_kg is drained_kg"
run mcc --scheme implicit --cell 0.05 --times 0.1,0.2
within mcc 0.03 0.02
run terzaghi --scheme implicit --cell 0.05
within terzaghi 0.012 0.02
run mandel --scheme implicit --cell 0.2 --water-stiffness 50 --times 0.05,0.2
within mandel 0.03 0
run barron --cell 0.1 --times 0.2,1
within barron 0.03 0
awk -v u="$(value barron degree)" -v e="$(value barron degree_equal_strain)" -v f="$(value barron plate_force)" 'BEGIN {
  exit !(u > 0.97 * e && u < 1.03 * e && f > 0.98 && f < 1.02) }' || fail "barron: degree and force of the plate"
# Both sides drained, two layers, a load that grows, and steps of an oedometer.
run terzaghi --scheme implicit --drainage both --times 0.05,0.2
within terzaghi 0.015 0.02
run terzaghi --drainage bottom --cell 0.1 --water-stiffness 50 --times 0.3
within terzaghi 0.02 0.02
run terzaghi --layers "$(dirname "$0")/data/consolidation_layers.csv" --times 0.1,0.5
within terzaghi 0.015 0.02
in_range "$work/terzaghi/summary.json" height 5 5
in_range "$work/terzaghi/summary.json" U 0.69 0.73 # by finite differences 0.7144
in_range "$work/terzaghi/summary.json" t 1.53e7 1.57e7 # s: 0.5 H^2/c_v, c_v = 2.174e-9 3.636e6/9806.65 m2/s
run terzaghi --scheme implicit --load-ramp 0.2 --times 0.1,0.2,0.5
within terzaghi 0.015 0.02
run mcc --scheme implicit --loads 100kPa,300kPa --times 0.2,2
within mcc 0.03 0.01
in_range "$work/mcc/summary.json" U 0.99 1.0
[ "$(wc -l <"$work/mcc/steps.csv")" = 3 ] || fail "rows of steps.csv"
awk -F, 'NR > 1 && ($7 - $8) ^ 2 > 1e-5 { exit 1 }' "$work/mcc/steps.csv" || fail "void ratios of the steps"
refused() {
  if "$programs/mps-consolidation" --out "$work/refused" "$@" 2>"$work/log"; then fail "$* is not refused"; fi
}
refused --M 1
refused --case mcc --young 1MPa
refused --case mcc --kappa 0.3
refused --case mcc --load 1e8
refused --drain-ratio 4
refused --case barron --cell 0.08333333333
run strip --cell 0.5
within strip 0.03 0
run strip --cell 0.5 --scheme implicit
within strip 0.03 0
exit 0
