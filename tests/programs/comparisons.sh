#!/bin/sh
# comparisons.sh DIRECTORY: every program that compares with theory, an experiment or a formula, run where the
# assumptions of that do not hold: null in summary.json, the reason there and in a line, and no difference printed;
# and where they hold.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
programs=$1
run() { # PROGRAM OPTION...
  program=$1
  shift
  [ -x "$programs/$program" ] || return 1
  rm -rf "$work/o"
  "$programs/$program" "$@" --threads 1 --out "$work/o" >"$work/out" 2>"$work/log" || fail "$program $*: $(cat "$work/log")"
}
# without KEYS REASON PROGRAM OPTION...: all keys are null, KEY_reason of the first, or the first itself where it ends
# so, is the reason; it is printed, and no percentage unless another comparison holds (`partly`).
without() {
  keys=$1
  reason=$2
  shift 2
  run "$@" || return 0
  first=${keys%% *}
  case $first in *_reason) ;; *) first=${first}_reason ;; esac
  for key in $keys; do
    case $key in *_reason) continue ;; esac
    has "$work/o/summary.json" "\"$key\": null"
  done
  grep -q "\"$first\": \".*$reason" "$work/o/summary.json" || fail "$*: $first: $(grep "$first" "$work/o/summary.json")"
  grep -q "^No comparison with .*$reason" "$work/out" || fail "$*: no line: $(cat "$work/out")"
  [ -n "${partly:-}" ] || ! grep -v "^No comparison" "$work/out" | grep -q "[-+][0-9.]* %" || fail "$*: a difference: $(cat "$work/out")"
}
# with KEY PROGRAM OPTION...: a number, and no reason
with() {
  key=$1
  shift
  run "$@" || return 0
  in_range "$work/o/summary.json" "$key" -1e30 1e30
  has "$work/o/summary.json" "\"${key}_reason\": null"
  ! grep -q "^No comparison" "$work/out" || fail "$*: $(cat "$work/out")"
}

# Waves: a record, a slope, damping, a pulse longer than the ground.
awk 'BEGIN { for (k = 0; k <= 200; k++) print k / 100 "," sin(k / 5) * sin(k / 17) }' >"$work/record.csv"
waves="mps-wave --spacing 2 --courant 0.5"
column="$waves --width 4 --height 20"
with travel_time_exact $column --duration 0.7
without "travel_time_exact surface_peak_theory" "the input is a record" $column --record "$work/record.csv" --duration 1
without "travel_time_exact surface_peak_theory" "not level" $waves --width 20 --height 20 --incline 5,10,12 --duration 0.7
partly=1
without surface_peak_theory "damped" $column --damping 0.05 --duration 0.7
without surface_peak_theory "its reflection from the base arrives" $waves --width 4 --height 12 --duration 0.7
partly=

# Critical steps: Euler's growth beside the response itself, and the paper's table.
without "dt_linear dt_table2" "near the response itself" mps-stability --spacing 3.2 --integrator euler --criterion 2.2 --damping 0.1
with dt_linear mps-stability --spacing 3.2 --integrator verlet
without dt_table2 "Vp = 2 Vs" mps-stability --spacing 3.2 --vs 100 --vp 300 --damping 0.05

# Layers: undamped on a rigid base, a record cut short, large strains, a law that is not elastic.
printf 'thickness_m, density_kg_m3, vs_m_s\n12, 1800, 120\n' >"$work/bare"
printf 'thickness_m, density_kg_m3, vs_m_s\n12, 1800, 120\ninf, 1800, 480\n' >"$work/half"
printf 'thickness_m, density_kg_m3, vs_m_s, law, reference_strain\n12, 1800, 120, smallstrain, 0.001\ninf, 1800, 480\n' >"$work/soil"
site="mps-site-response --frequency 3 --max-frequency 5"
without "amplification_exact amplification_error" "rigid base" $site --layers "$work/bare" --base rigid --duration 2
without "amplification_exact amplification_error" "still moves" $site --layers "$work/half" --duration 1
without "amplification_exact amplification_error" "shear strains reach" $site --layers "$work/half" --acceleration 40 --duration 6
without "amplification_exact amplification_error" "not linear elastic" $site --layers "$work/soil" --duration 2
with amplification_exact $site --layers "$work/half" --duration 6

# A cone near the surface, a rough one, a blunt one; a sphere that is deep, and in a small box.
cone="mps-penetrometer --cell 0.025 --corner 0 --rate 1 --ppc 1"
without "n_kt_teh_houlsby n_kt_lu" "deep cone" $cone --law tresca --ir 100 --soil 0.4x0.4x0.4 --depth 0.1
without "n_kt_teh_houlsby n_kt_lu" "smooth cone" $cone --law tresca --ir 100 --soil 0.4x0.4x0.4 --depth 0.05 --friction 0.3
without "n_kt_teh_houlsby n_kt_lu" "60 degrees" $cone --law tresca --ir 100 --soil 0.4x0.4x0.4 --depth 0.05 --apex-angle 90
with n_kt_lu $cone --law tresca --ir 100 --start 0.5 --depth 0.63 --soil 0.8x0.8x0.8 --sides free
sphere="mps-penetrometer --tip sphere --law elastic --poisson 0.3 --diameter 1 --ppc 1"
without "force_hertz hertz_error" "half space" $sphere --cell 0.1 --soil 1.2x1.2x1 --depth 0.02 --rate 0.02
without "force_hertz hertz_error" "a small one" $sphere --cell 0.1 --soil 2x2x1 --depth 0.1 --rate 0.1

# A footing that is fast, not yet at its capacity, on ground of other flow, of two layers; not one far pressed.
footing="mps-footing --cell 0.25 --soil 3x1"
without q_exact "inertia" $footing --rate 50mm/s
with q_exact $footing --young 20MPa --rate 20mm/s --settlement 50mm
without q_exact "has not reached" $footing --rate 5mm/s --settlement 0.05mm
without "q_exact q_exact_smooth q_exact_rough" "associated flow" $footing --law druckerprager --psi 0 --rate 5mm/s --settlement 1mm
without q_exact "two layers" $footing --rate 5mm/s --top 0.5 --top-cohesion 5kPa
without q_exact "between which" $footing --law druckerprager --friction 0.2 --rate 5mm/s --settlement 1mm
with q_exact $footing --rate 5mm/s

# A wall that turns about its top, is rough in the passive case, fast, short of ground; sand of other flow.
wall="mps-wall --cell 0.2 --rate 0.2"
without K_theory "arches" $wall --motion top
without K_theory "passive case" $wall --pressure passive --friction 0.3 --below-toe 0.8 --length 3
without K_theory "inertia" mps-wall --cell 0.2 --pressure passive --length 3 --rate 2
without K_theory "wedge would reach" $wall --pressure passive --length 1.2
without K_theory "mobilises less" mps-wall --cell 0.2 --rate 0.05 --below-toe 0.8
without K_theory "slides along" mps-wall --cell 0.2 --rate 0.05 --friction 0.3

# A disc that hops, or is soft; a block with friction.
without "x_theory x_error_05" "hops" mps-rolling-disc --friction 0.6 --contact penalty --fill lattice
steep="mps-rolling-disc --slope-angle 42 --friction 0.2 --fill lattice"
for young in 10MPa 30MPa 100MPa; do # springs push its corners out of the slope; impulses do not
  without "x_theory x_error_05" "off the slope" $steep --young $young --contact penalty
  with x_theory $steep --young $young
  [ -x "$programs/mps-rolling-disc" ] && in_range "$work/o/summary.json" x_error_05 -0.015 0.015
done
with x_theory mps-rolling-disc --slope-angle 42 --friction 0.2 --young 30MPa --fill rings
[ -x "$programs/mps-rolling-disc" ] && in_range "$work/o/summary.json" x_error_05 -0.01 0.01
without "x_theory x_error_05" "soft" mps-rolling-disc --cell 0.02 --young 20kPa --duration 0.1
with x_theory mps-rolling-disc --cell 0.02
without Fy_smooth "lifts off" mps-sliding-box --cell 0.05
with Fy_smooth mps-sliding-box --cell 0.05 --friction 0

# Columns of clay, of sand that dilates, on a smooth bed, stopped; water that is thick, small, short of its tank.
heap="mps-column-collapse --cell 0.025 --ppc 1 --frames 0"
without "runout_law runout_error height_law" "cohesion" $heap --cohesion 500Pa --falls 1
without "runout_law runout_error height_law" "sands" $heap --phi 10 --falls 1
without "runout_law runout_error height_law" "in plane strain" $heap --cone circumscribed --falls 1
without "runout_law runout_error height_law" "still moves" $heap --falls 0.5
without "runout_law runout_error height_law" "slides on the bed" $heap --friction 0.1 --falls 1
dam="mps-dam-break --cell 0.01 --frames 0"
without "experiment_reason front_error_rms height_error_rms" "viscosity" $dam --width 0.05 --viscosity 5 --duration 0.15
without "experiment_reason front_error_rms height_error_rms" "surface tension" mps-dam-break --frames 0 --width 0.01 --cell 0.002 --duration 0.05
without "experiment_reason front_error_rms height_error_rms" "far wall" $dam --width 0.05 --tank 2 --duration 0.15
without "experiment_reason front_error_rms height_error_rms" "ends before" $dam --width 0.05 --duration 0.02

# Water that gives way; high sloshing, a thick drop, a box let go far from rest; steep and long waves, few of a sea.
without "exact_reason settlement_exact U_exact pressure_error" "gives way" mps-consolidation --cell 0.3333333333 --water-stiffness 5 --times 0.01
without "exact_reason settlement_exact U_exact pressure_error" "inertia" mps-consolidation --cell 0.3333333333 --water-stiffness 20 --times 0.1 --time-unit 0.02
with slip_circles mps-slope --cell 2 --factor 1.5
without slip_circles "softens" mps-slope --runout --cell 2 --phi 0 --cohesion 20kPa --residual-cohesion 5kPa --falls 0.5
tank="mps-tank --spacing 0.05 --frames 0"
without period_exact "small motion" $tank --case sloshing --amplitude 0.07 --duration 1
with period_exact $tank --case sloshing --viscosity 1 --duration 3
without a_exact "nu over the square" mps-tank --frames 0 --case drop --viscosity 100 --duration 0.05
without period_exact "from rest" mps-tank --spacing 0.04 --draft 0.16 --depth 0.6 --frames 0 --case float --amplitude 0.036 --duration 0.2
without gauge_height_linear "without viscosity" $tank --case piston --amplitude 0.05 --period 1.2 --viscosity 100 --duration 4 --gauge 0.5
flume="mps-flume --spacing 0.05 --length 3 --frames 0 --absorb none"
without force_goda "the window has" $flume --waves jonswap --height 0.08 --period 1.2 --wall caisson --freeboard 0.4 --duration 16
exit 0
