#!/bin/sh
# footing.sh DIRECTORY: the capacity of mps-footing is that of undeformed ground, whatever stiffness, width and cell;
# soft ground bears more as it deforms. A run that goes on from a checkpoint is the whole run.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
programs=$1

# bears NAME KEY LOW HIGH OPTION...
bears() {
  at="$work/$1" key=$2 low=$3 high=$4
  shift 4
  "$programs/mps-footing" --threads 1 --out "$at" "$@" >"$work/log" 2>&1 || exit 1
  in_range "$at/summary.json" "$key" "$low" "$high"
}
# Prandtl's 5.1416 within 2 %, by stiffness, width and cell.
bears default q_over_c 5.039 5.245
has "$work/log" "bearing capacity of the undeformed ground"
picture "$work/default/pressure.png" 1000x680 1f4e8c c0392b
picture "$work/default/shear_bands.png" 1085x0 888888 08306b
bears soft q_over_c 5.039 5.245 --cohesion 5kPa --young 2.5MPa
in_range "$work/soft/summary.json" q_deformed 26500 31000
has "$work/log" "as the ground deforms"
bears stiff q_over_c 5.039 5.245 --young 20GPa
bears wide q_over_c 5.039 5.245 --half-width 5 --cell 1 --cohesion 100kPa --young 50MPa
bears fine q_over_c 5.039 5.245 --cell 0.0625 --soil 2x1.25
# Sand with cohesion, 36.81; by its weight alone (7.653, on five cells); 24.1 with Davis' strength where psi is less.
bears sand q_over_c 36.07 37.55 --law druckerprager --soil 3x1.5
bears weight q_over_weight 7.27 8.4 --law druckerprager --cohesion 0 --soil 2x0.8 --rate 0.2mm/s
in_range "$work/weight/summary.json" q_exact 37550 37640
bears weak q_over_weight 1.506 1.664 --law druckerprager --cohesion 0 --phi 20
# Steep sand (45 degrees, 116.6), where the open ground beside the edge takes nothing off the ground under it.
bears steep q_over_weight 104.9 122.4 --law druckerprager --cohesion 0 --phi 45 --young 31GPa --settlement 0.213mm --cell 0.125
# A rough base (14.75) bears the same wherever its edge lies: just beyond a line of nodes.
bears rough q_over_weight 14.01 15.49 --law druckerprager --cohesion 0 --friction 1 --half-width 0.306
# at two thirds of the speed, with a shorter flip_time, 7 % less
bears slow q_over_weight 13.5 15.49 --law druckerprager --cohesion 0 --friction 1 --half-width 0.306 --rate 0.04mm/s
in_range "$work/slow/summary.json" flip_time 0.0402 0.0403
bears psi q_over_c 24.1 36.81 --law druckerprager --psi 0 --soil 3x1.5 --cell 0.125
in_range "$work/psi/summary.json" q_davis 240e3 242e3
# Other cones have angles of their own in plane strain: 25 degrees are 26.2 through the edges of extension (c 1.055 times as
# large, 23.81 c), 12 degrees 15.1 through those of compression (1.271 times, 14.05 c).
free="--law druckerprager --gravity 0 --cohesion 6kPa --soil 3x1.5"
bears extension q_over_c 22.9 24.3 $free --phi 25 --cone extension
in_range "$work/extension/summary.json" q_exact 142.7e3 143.1e3
bears compression q_over_c 13.3 14.4 $free --phi 12 --cone circumscribed
in_range "$work/compression/summary.json" q_exact 84.1e3 84.5e3
! grep -q "cannot exceed" "$work/compression/summary.json" || fail "a bound of another cone"
# Dense sand whose dilation soon ends fails, and bears less at the end of the path: that is not its capacity.
falls="--law druckerprager --phi 40 --e0 0.93 --cell 0.125 --young 10GPa --soil 2x1 --settlement 10mm --rate 20mm/s"
"$programs/mps-footing" $falls --threads 1 --out "$work/falls" >"$work/log" 2>&1 || exit 1
has "$work/log" "the ground has failed before the end of the path"
has "$work/falls/summary.json" '"q_exact": null'
! grep -q "from its largest" "$work/sand/summary.json" "$work/weight/summary.json" || fail "sand that has not failed"
# A circle that sinks by a third of its radius lifts its rim off the ground late, by the cells: said beyond 0.15 radii.
for sunk in 0.1 0.35; do
  "$programs/mps-footing" --shape circle --soil 2x1.5 --young 3MPa --rate 20mm/s --settlement "$(awk "BEGIN { print 0.5 * $sunk }")" \
    --threads 1 --out "$work/sunk$sunk" >"$work/log" 2>&1 || exit 1
done
has "$work/sunk0.35/summary.json" "deformed ground bears under a circle depends on the cell"
! grep -q "depends on the cell" "$work/sunk0.1/summary.json" || fail "a warning of a footing that has hardly sunk"
# Strength that grows by 4 c/B: characteristics have 7.819.
bears grows q_over_c 7.5 8.15 --strength-gradient 40kPa/m --soil 2x1
has "$work/log" "characteristics"
in_range "$work/grows/summary.json" q_exact 78180 78200
# A load a fifth of the width off the middle is borne by B - 2 e, and the strip turns to its side; a run that goes on is the whole run.
off="--eccentricity 0.2 --soil 3x1 --rate 5mm/s --flip-time 10ms --settlement 0.4mm"
bears off q_over_c 2.93 3.24 $off --checkpoint "$work/off.h5"
has "$work/log" "Meyerhof, B - 2 e"
in_range "$work/off/summary.json" q_exact 30849 30850
in_range "$work/off/summary.json" turned -0.2 -0.02
"$1/mps-footing" $off --threads 2 --restart "$work/off.h5" --out "$work/off2" >/dev/null
cmp "$work/off/pressure.csv" "$work/off2/pressure.csv" || fail "the eccentric run that went on"
"$1/mps-footing" --soil 2x1.2 --restart "$work/off.h5" --out "$work/off2" 2>"$work/log" &&
  fail "a restart with other options"
grep -q "was made with other options" "$work/log" || fail "which option differs"
# Sharp edges and each particle's own change of volume bear more than any such ground, which is warned of; see `default`.
"$programs/mps-footing" --threads 1 --out "$work/above" --corner 0 --volumetric point --soil 2x1 >"$work/log" 2>&1
has "$work/log" "% above that of Prandtl, which such ground cannot exceed"
has "$work/above/summary.json" "which such ground cannot exceed"
! grep -q "cannot exceed" "$work/default/summary.json" || fail "a warning of a bound that holds"
# A path too short for the capacity is warned of.
bears short q 10e3 40e3 --settlement 0.05mm
has "$work/log" "has not reached its bearing capacity"
has "$work/short/summary.json" "has not reached its bearing capacity"
# Ctrl-C in the first of two runs.
soft="--cohesion 5kPa --young 2.5MPa --soil 2x1.2 --cell 0.05"
timeout -s INT 0.6 "$1/mps-footing" $soft --threads 1 --checkpoint "$work/cut.h5" --out "$work/cut" >/dev/null 2>&1 || true
[ -s "$work/cut.h5" ] || exit 0 # too slow a machine: it had not begun
"$1/mps-footing" $soft --threads 2 --restart "$work/cut.h5" --out "$work/rest" >/dev/null
"$1/mps-footing" $soft --threads 1 --out "$work/cut" >/dev/null
for file in pressure.csv pressure_deformed.csv; do
  cmp "$work/cut/$file" "$work/rest/$file" || fail "the run that was interrupted"
done
exit 0
