#!/bin/sh
# tank.sh DIRECTORY: mps-tank against theory; docs/verification/fluid.md has the bars.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"

tank() { "$1/mps-tank" --threads 1 --frames 2 --out "$work/$2" --case "$2" >"$work/log"; }
tank "$1" still
in_range "$work/still/summary.json" force_mean 441.44 441.46
in_range "$work/still/summary.json" force_std 0 0.001
# Density of the particles over the height: the water's, half of it at the surface, none above.
"$1/mps-tank" --case still --duration 0.05 --density-at 0.3 --threads 1 --frames 0 --out "$work/density" >"$work/log"
is "$work/density/density.csv" density_kg_m3 20 1000 10
is "$work/density/density.csv" density_kg_m3 60 500 100
is "$work/density/density.csv" density_kg_m3 -1 0 1e-9
picture "$work/density/density.png" 700x640 1f4e8c c0392b
tank "$1" sloshing
in_range "$work/sloshing/summary.json" period_exact 1.01335 1.01337
in_range "$work/sloshing/summary.json" period 1.0083 1.0184
in_range "$work/sloshing/summary.json" decay -0.03 0.03
# The classical scheme runs; of its force only the mean is right.
"$1/mps-tank" --case still --method classical --threads 1 --frames 0 --out "$work/classical" >"$work/log"
in_range "$work/classical/summary.json" force_mean 397 486
# Coupled: frequencies with the added mass of potential flow, the plate's rest under water and own weight.
coupled() { "$1/mps-tank" --threads 1 --frames 0 --out "$work/$2" --case "$2" --duration "$3" >"$work/log"; }
coupled "$1" spring 0.5
in_range "$work/spring/summary.json" omega_exact 60.3 60.4
in_range "$work/spring/summary.json" omega 60.05 60.65
in_range "$work/spring/summary.json" solutions_a_step 1 4
# A fast wall begins with so small a displacement that the water need not pull at it.
"$1/mps-tank" --case spring --mass 5 --stiffness 5e5 --depth 0.2 --duration 0.15 --dt 2.5e-4 --threads 1 \
  --frames 0 --out "$work/fast" >"$work/log"
in_range "$work/fast/summary.json" omega 136.4 137.8 # 137.10 by theory
coupled "$1" plate 0.1
in_range "$work/plate/summary.json" omega_exact 503.0 503.2
in_range "$work/plate/summary.json" omega 498.1 508.1
in_range "$work/plate/summary.json" deflection 6.791e-5 6.929e-5
in_range "$work/plate/summary.json" decay -0.5 0.5
picture "$work/plate/structure.png" 1000x460 1f4e8c
# A light plate under forty times its mass of water, of three stiffnesses: omega^2 and rest go by E.
for young in 3e10 1e11 3e11; do
  "$1/mps-tank" --case plate --plate-length 0.6 --depth 0.5 --plate-density 1200 --plate-thickness 0.01 --spacing 0.05 \
    --young "$young" --dt 5e-5 --duration 0.08 --threads 1 --frames 0 --out "$work/light-$young" >"$work/log"
done
in_range "$work/light-3e10/summary.json" deflection 5.94e-4 6.06e-4 # 5.997e-4 by the plate's theory
in_range "$work/light-1e11/summary.json" deflection 1.78e-4 1.82e-4
in_range "$work/light-3e11/summary.json" deflection 5.94e-5 6.06e-5
in_range "$work/light-3e11/summary.json" omega 525 536 # 530.4 by potential flow
# In waves near its own frequency: linear potential flow of this tank, and of an endless flume.
"$1/mps-tank" --case resonance --spacing 0.02 --threads 1 --frames 0 --out "$work/resonance" >"$work/log"
in_range "$work/resonance/summary.json" radiation_damping 389.6 389.8
in_range "$work/resonance/summary.json" deflection_flume 0.01999 0.02001 # at resonance the wall moves as twice the piston
in_range "$work/resonance/summary.json" deflection_exact 0.01964 0.01984
in_range "$work/resonance/summary.json" deflection 0.0186 0.0199
in_range "$work/resonance/summary.json" phase 65 72 # 69.4 by theory
# A box that floats: its heave about its rest by potential flow, matched eigenfunctions (.9124 s).
"$1/mps-tank" --case float --threads 1 --frames 0 --out "$work/float" >"$work/log"
in_range "$work/float/summary.json" period_exact 0.9121 0.9127
in_range "$work/float/summary.json" period 0.8942 0.9306
in_range "$work/float/summary.json" deflection -0.0051 -0.0049 # load over stiffness
picture "$work/float/structure.png" 1000x460 1f4e8c
picture "$work/float/water.png" 1078x0 2c3e8f
tank "$1" drop
in_range "$work/drop/summary.json" a 0.4329 0.4461
in_range "$work/drop/summary.json" b 2.2641 2.2869
in_range "$work/drop/summary.json" p_c_error_max 0 0.05 # .14 where the lattice is perfect and buckles
# Waves of a piston: nonlinear potential flow has crests of 527.8, 548.2 and 532.4 N and a trough of 334.1.
"$1/mps-tank" --threads 1 --frames 2 --gauge 0.3,0.5 --out "$work/piston" >"$work/log"
in_range "$work/piston/summary.json" crest_force 544.5 552.3
in_range "$work/piston/summary.json" trough_force 331.8 336.4
in_range "$work/piston/summary.json" collisions 0 0
in_range "$work/piston/summary.json" gauge_height 0.0635 0.069 # linear potential flow: .0675
in_range "$work/piston/summary.json" gauge_height_linear 0.0665 0.0685
in_range "$work/piston/summary.json" force_harmonic 88.0 93.6 # 90.9; 87.7 where samples leave out part of a period
head -n 1 "$work/piston/gauges.csv" | grep -q '^t_s,level_at_0.3_m,level_at_0.5_m,level_at_wall_m$' ||
  fail "header of gauges.csv: $(head -n 1 "$work/piston/gauges.csv")"
picture "$work/piston/force.png" 1000x700 1f4e8c
picture "$work/piston/water.png" 1085x0 2c3e8f

# On from a checkpoint, and from one that Ctrl-C left: the results of the run that never stopped.
[ -f "$work/piston/water.vtkhdf" ] || exit 0 # built without HDF5
again() { # CASE OPTION...
  kind=$1
  shift
  "$programs/mps-tank" --case "$kind" "$@" --threads 1 --frames 3 --out "$work/whole-$kind" >"$work/log"
  "$programs/mps-tank" --case "$kind" "$@" --threads 2 --frames 3 --out "$work/on-$kind" \
    --restart "$work/whole-$kind/checkpoint.h5" >"$work/log"
  for file in "$work/whole-$kind"/*.csv "$work/whole-$kind/summary.json"; do
    cmp "$file" "$work/on-$kind/$(basename "$file")" || fail "$kind after a restart"
  done
}
programs=$1
short="--case spring --amplitude 1e-4 --duration 0.1 --threads 1 --frames 0"
"$1/mps-tank" $short --stiffness 1e6 --dt 0.004 --out "$work/long-steps" >"$work/out" 2>"$work/log"
has "$work/log" "warning: a step of 0.004 s is too long for a structure that swings with 130.4 rad/s"
"$1/mps-tank" $short --stiffness 211800 --dt 0.004 --out "$work/short-steps" >"$work/out" 2>"$work/log"
if grep -q "too long for a structure" "$work/log"; then fail "a warning of omega dt 0.24"; fi
again piston --duration 0.5 --every-checkpoint 0.3 --sample 0.001
again spring --duration 0.05 --every-checkpoint 0.03
again plate --duration 0.02 --every-checkpoint 0.012
again float --duration 0.3 --every-checkpoint 0.2
again drop --duration 0.5 --every-checkpoint 0.3
run="--case spring --duration 0.4 --threads 1 --frames 0"
"$1/mps-tank" $run --every-checkpoint 0.02 --checkpoint "$work/c.h5" --out "$work/cut" >"$work/out" 2>"$work/log" &
pid=$!
until [ -f "$work/c.h5" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.02; done
kill -INT "$pid" 2>/dev/null || :
wait "$pid" || :
has "$work/out" "--restart $work/c.h5"
"$1/mps-tank" $run --out "$work/uncut" >"$work/log"
"$1/mps-tank" $run --restart "$work/c.h5" --out "$work/on" >"$work/log"
for file in force.csv structure.csv particles.csv summary.json; do
  cmp "$work/uncut/$file" "$work/on/$file" || fail "another $file after Ctrl-C and a restart"
done
if "$1/mps-tank" $run --restart "$work/c.h5" --mass 11 --out "$work/other" 2>"$work/log"; then
  fail "a restart with another --mass"
fi
has "$work/log" "c.h5 was made with other options: --mass is 11, was 10"

# A plate that bends by more than .3 of its thickness is warned of, a stiff one is not.
"$1/mps-tank" --case plate --spacing 0.1 --young 8GPa --plate-thickness 0.02 --plate-density 7800 --duration 0.05 \
  --frames 0 --out "$work/thin" >/dev/null 2>"$work/warned"
has "$work/warned" "warning: the plate bends by"
"$1/mps-tank" --case plate --spacing 0.1 --duration 0.05 --frames 0 --out "$work/thick" >/dev/null 2>"$work/warned"
! grep -q "bends by" "$work/warned" || fail "a stiff plate is warned of: $(cat "$work/warned")"

# Viscosities below that of the scheme, .26 (g l0^3)^1/2, and above.
for l0 in 0.05 0.04 0.025; do
  for viscosity in 1 60; do
    "$1/mps-tank" --case sloshing --spacing $l0 --length 0.6 --viscosity $viscosity --duration 0.5 --threads 1 --frames 0 \
      --out "$work/thick" >"$work/log" 2>&1
    case $viscosity in
    1) has "$work/log" "--viscosity 1 Pa s has no effect: that of the scheme is" ;;
    *) ! grep -q "has no effect" "$work/log" || fail "a viscosity that has an effect is warned of" ;;
    esac
  done
done

# Options of other cases, and a window after the run, would look used.
for unused in "still --amplitude 0.05" "sloshing --mass 3" "sloshing --period 2" "float --plate-length 2" "plate --length 2" \
  "drop --gauge 0.1" "resonance --stiffness 1e4 --frequency-ratio 0.8" "piston --draft 0.1"; do
  if "$1/mps-tank" --case $unused --duration 0.01 --frames 0 --out "$work/unused" >/dev/null 2>"$work/log"; then fail "--case $unused"; fi
  has "$work/log" "is not used: it needs --case"
done
if "$1/mps-tank" --case still --duration 1 --window 2,3 --frames 0 --out "$work/unused" >/dev/null 2>"$work/log"; then
  fail "a window after the run"
fi
has "$work/log" "window must begin before the end of the run"
for unused in "mps --courant 0.3" "mps --bed fixed" "mpm --disturb 0.1"; do
  if "$1/mps-dam-break" --method $unused --duration 0.01 --frames 0 --out "$work/unused" >/dev/null 2>"$work/log"; then fail "$unused"; fi
  has "$work/log" "is not used: it needs --method"
done
# A run of too few periods knows no decay, and prints none.
for case in float spring; do
  "$1/mps-tank" --case $case --spacing 0.02 --duration $([ $case = float ] && echo 2 || echo 0.2) --frames 0 --threads 1 \
    --out "$work/few" >"$work/log" 2>/dev/null
  ! grep -q nan "$work/log" || fail "nan of --case $case: $(cat "$work/log")"
done
