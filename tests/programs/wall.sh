#!/bin/sh
# wall.sh DIRECTORY: mps-wall against Rankine's coefficients on a smooth wall, at 30 degrees 1/3 and 3, with
# cohesion, between those of a wall that pulls and of ground with a tension crack, and against Coulomb's on a
# rough one with ground below, which alone have Coulomb's wedge; the force of a wall that turns about its top acts higher.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"

wall() { # NAME OPTION...
  name=$1
  shift
  "${programs}/mps-wall" --cell "${h:-0.125}" --rate "${rate:-0.04}" "$@" --threads 1 --out "$work/$name" >"$work/log" || exit 1
}
programs=$1
value() { sed -n "s/^ *\"$2\": \([^,]*\),*$/\1/p" "$work/$1/summary.json"; }

wall active
in_range "$work/active/summary.json" K 0.32 0.347
in_range "$work/active/summary.json" K_theory 0.33333 0.33334
in_range "$work/active/summary.json" force_height 0.32 0.35
wall passive --pressure passive --length 3
in_range "$work/passive/summary.json" K 2.91 3.09
wall toe --pressure passive --length 3 --below-toe 0.5 # which a sharp toe presses too
in_range "$work/toe/summary.json" K 2.85 3.15
in_range "$work/toe/summary.json" K_along -0.003 0.003
! grep -q "cannot exceed" "$work/passive/summary.json" || fail "a warning of a bound that holds"
# About its toe, beside which the ground yields last, a wall turns until all of it has.
h=0.0625 wall turned --motion toe --phi 33 --psi 33
in_range "$work/turned/summary.json" K 0.295 0.31 # Rankine .2948
h=0.0625 wall pressed --motion toe --pressure passive --phi 33 --psi 33 --length 4
in_range "$work/pressed/summary.json" K 3.29 3.49 # 3.3921
wall sharp --pressure passive --length 3 --below-toe 0.5 --inset 0 --corner 0
has "$work/sharp/summary.json" "above that of a sliding wedge, which such ground cannot exceed"
# Sand that does not dilate, on a smooth bed: between Rankine of phi and of phi*, tan(phi*) = sin(phi); the more friction
# and the smaller the cells, the further below the first.
for phi in 27 33 42; do
  [ "$phi" = 42 ] && h=0.0625 || h=0.125
  wall "sand$phi" --pressure passive --length 4 --phi "$phi" --young 200MPa
  has "$work/log" "with the strength that Davis takes for psi < phi"
  awk -v phi="$phi" -v low="$(value "sand$phi" K_reduced)" -v K="$(value "sand$phi" K)" 'BEGIN {
    x = phi * 3.14159265358979 / 180; s = sin(x); t = s / sqrt(1 + s * s)
    print "K " K ", by Davis " low; exit !((low * (1 - t) / (1 + t) - 1) ^ 2 < 1e-10 && K > 0.97 * low &&
      K < 1.03 * (1 + s) / (1 - s) && (phi < 42 || K < 0.95 * (1 + s) / (1 - s))) }' || fail "passive sand of $phi degrees"
done
unset h
wall bedded --pressure passive --friction 0.3
has "$work/log" "slides along with the wall, and resists less than ground that continues below it"
wall clay --pressure passive --length 3 --phi 0 --cohesion 5kPa
in_range "$work/clay/summary.json" K 2.09 2.18 # 1 + 4 c/(gamma H) = 2.133
wall cohesive --phi 25 --cohesion 1413Pa # 0.08002 gamma H
in_range "$work/cohesive/summary.json" K 0.198 0.228
in_range "$work/cohesive/summary.json" K_theory 0.20193 0.20196 # K - 4 c/(gamma H) sqrt(K)
in_range "$work/cohesive/summary.json" K_cracked 0.22754 0.22757 # K (1 - 2 c/(gamma H sqrt(K)))^2
h=0.0625 wall rough --phi 36 --friction 0.445 --below-toe 0.5
in_range "$work/rough/summary.json" K 0.19 0.25 # of Coulomb's wedge 0.2146, in sand that does not dilate more
has "$work/rough/summary.json" '"K_theory": null' # psi is 0, and the wedge is of associated sand
wall bed --phi 36 --friction 0.445
has "$work/bed/summary.json" '"K_theory": null'
wall based --below-toe 0.5 --psi 30 # by a smooth bed's value, though the ground below the toe stays
in_range "$work/based/summary.json" K 0.317 0.35
has "$work/based/summary.json" '"K_reduced": null'
wall tip --below-toe 0.5 --psi 30 --sheet 0 # ground beside a toe at the level in front loses its pressure
in_range "$work/tip/summary.json" K 0.15 0.3
rate=0.08 wall loose --below-toe 0.5
in_range "$work/loose/summary.json" K_reduced 0.38196 0.38198 # tan(phi*) = sin(30 degrees)
wall loaded --surcharge 5kPa # K (1 + 2 q/(gamma H)) = 0.52210
in_range "$work/loaded/summary.json" K 0.506 0.538
in_range "$work/loaded/summary.json" K_theory 0.52209 0.52211
wall both --surcharge 5kPa --below-toe 0.5 --psi 30
in_range "$work/both/summary.json" K 0.49 0.555
# Water at rest in the ground, layers, and friction of the wall between none and full: psi = phi.
wall wet --water-table 0.25 --density 2000
in_range "$work/wet/summary.json" K_theory 0.23957 0.23959 # (1 - 0.5 0.75^2)/3
in_range "$work/wet/summary.json" K 0.230 0.247
in_range "$work/wet/summary.json" water_force 2759 2759.1
wall drowned --water-table 0 --density 2000 --pressure passive --length 3
in_range "$work/drowned/summary.json" K_theory 1.49999 1.50001
in_range "$work/drowned/summary.json" K 1.46 1.55
layers=$(dirname "$0")/data/wall_layers.csv
printf 'thickness_m, phi_degrees, psi_degrees, cohesion_Pa, density_kg_m3\n0.29, 20, 0, 0, 1800\n2, 33, 0, 0, 1900\n' >"$work/off.csv"
wall off --layers "$work/off.csv"
has "$work/off/summary.json" "layer 1 of --layers ends at 0.29 m, taken as 0.3125 m"
wall layers --layers "$layers"
# 0.27099 1700 g/8 + 0.40586 (1700 g/4 + 1900 g/8) = 3202.6 N/m over (1700/8 + 1700/4 + 1900/8) g = 8583.8 N/m
in_range "$work/layers/summary.json" K_theory 0.37305 0.37312
in_range "$work/layers/summary.json" K 0.36 0.385
wall pushed --layers "$layers" --pressure passive --length 3
in_range "$work/pushed/summary.json" K 2.68 2.85
wall delta --below-toe 0.5 --psi 30 --friction 0.17633
in_range "$work/delta/summary.json" K_theory 0.30377 0.30379 # Coulomb, 10 degrees
in_range "$work/delta/summary.json" K 0.285 0.32
wall top --motion top
awk -v low="$(value active force_height)" -v high="$(value top force_height)" \
  'BEGIN { exit !(high > low + 0.02) }' || fail "the height of the force"
# Walls of a model test have the K of high ones: by default they are as slow in terms of (g H)^1/2.
for high in 0.1 0.05 0.025; do
  "$programs/mps-wall" --height $high --cell "$(awk "BEGIN { print $high / 8 }")" --threads 1 --out "$work/low" >"$work/log" || exit 1
  in_range "$work/low/summary.json" K 0.326 0.334
done
picture "$work/active/pressure.png" 1000x640
picture "$work/active/ground.png" 1085x0
exit 0
