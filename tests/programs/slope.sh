#!/bin/sh
# slope.sh DIRECTORY: mps-slope finds the factor of safety of a slope of 2 : 1, phi 20, c/(gamma H) 0.05, that of
# limit equilibrium (1.38) and of finite elements (1.4: Griffiths and Lane 1999, example 1), whatever the stiffness
# and the cell; a slope of a strength that softens runs out further than one whose strength stays.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"

value() { sed -n "s/^ *\"$2\": \([^,]*\),*$/\1/p" "$1/summary.json"; }

# factor NAME LOW HIGH OPTION...
factor() {
  at="$work/$1" low=$2 high=$3
  shift 3
  "$programs/mps-slope" --threads 1 --out "$at" "$@" >"$work/log" || exit 1
  in_range "$at/summary.json" factor_of_safety "$low" "$high"
}
programs=$1
factor slope 1.363 1.391 --cell 1
has "$work/log" "by loss of equilibrium"
in_range "$work/slope/summary.json" log_spirals 1.376 1.379
! grep -q "cannot exceed" "$work/slope/summary.json" || fail "a warning of a bound that holds"
for young in 3MPa 30GPa; do
  factor "$young" 1.363 1.391 --cell 1 --young "$young"
done
awk -v a="$(value "$work/slope" factor_of_safety)" -v b="$(value "$work/30GPa" factor_of_safety)" \
  'BEGIN { exit !(b > 0.99 * a && b < 1.01 * a) }' || fail "the factor depends on the stiffness"
factor coarse 1.363 1.405 --cell 2
factor fine 1.349 1.391 --cell 0.5
# Clay on half a height of clay, 1.257 by circles; a vertical cut of phi 20, 1.090 by spirals (circles 0.998).
factor clay 1.22 1.295 --cell 1 --below-toe 5 --phi 0 --cohesion 39240
factor cut 1.057 1.123 --cell 1 --slope 0 --cohesion 40kPa
in_range "$work/cut/summary.json" log_spirals 1.089 1.091
[ "$(awk -F, '$7 == 1' "$work/slope/trials.csv" | wc -l)" -ge 1 ] || fail "no trial failed"
picture "$work/slope/slope.png" 1085x0 5b2c12
picture "$work/slope/motion.png" 1000x680 1f4e8c c0392b
# Steep sand of little cohesion oscillates about its equilibrium, elastically: no failure. Between spirals with the strength of
# Davis (psi is 0) and with all of it; 0.63 and 0.59 while that counted.
for sand in "10 3000 42 0.5" "4 1200 42 0.2" "10 3000 40 0.5"; do
  set -- "$1" $sand
  factor oscillates 0.7 1.3 --slope 1 --height "$2" --cohesion "$3" --phi "$4" --cell "$5"
  awk -v F="$(value "$work/oscillates" factor_of_safety)" -v least="$(value "$work/oscillates" log_spirals_davis)" \
    -v most="$(value "$work/oscillates" log_spirals)" 'BEGIN { exit !(F > least && F < most) }' || fail "a slope that oscillates"
  ! grep -q "strength of Davis" "$work/oscillates/summary.json" || fail "a warning of a factor that is credible"
done
# Twice the cohesion and tan(phi) have twice the factor: the strength of the trials is the same.
"$1/mps-slope" --cell 1 --phi 36.0524 --cohesion 19620 --factor 2.7 --threads 1 --out "$work/twice" >"$work/log"
has "$work/log" "the slope stands"
"$1/mps-slope" --cell 1 --phi 36.0524 --cohesion 19620 --factor 3.0 --threads 1 --out "$work/twice" >"$work/log"
has "$work/log" "the slope fails"
# Clay whose strength grows from nothing at the crest: slip circles have 4.106 k/gamma = 1.256, an upper bound.
grows="--cell 1 --slope 1 --phi 0 --strength-gradient 6kPa/m --young 1GPa --threads 1"
"$1/mps-slope" $grows --factor 1.19 --out "$work/grows" >"$work/log"
has "$work/log" "the slope stands"
"$1/mps-slope" $grows --factor 1.33 --out "$work/grows" >"$work/log"
has "$work/log" "the slope fails"
# Water: around the factors by slip circles, and of a line along the surface of sand (1 - gamma_w/gamma) 1.4.
water() { # STANDS FAILS OPTION...
  stands=$1 fails=$2
  shift 2
  "$programs/mps-slope" --cell 1 --factor "$stands" --threads 1 --out "$work/wet" "$@" >"$work/log"
  has "$work/log" "the slope stands"
  "$programs/mps-slope" --cell 1 --factor "$fails" --threads 1 --out "$work/wet" "$@" >"$work/log"
  has "$work/log" "the slope fails"
}
water 1.06 1.19 --ru 0.25
in_range "$work/wet/summary.json" slip_circles 1.112 1.122
water 1.75 2.0 --water-level 10
in_range "$work/wet/summary.json" slip_circles 1.83 1.85
water 0.80 0.90 --water-level 0 --drawdown 10
water 1.3 1.5 --slope 4 --phi 35 --psi 35 --cohesion 1Pa --water-level "$(dirname "$0")/data/water_line.csv" --seepage along
for kind in 15kPa 4kPa; do
  "$1/mps-slope" --runout --phi 0 --cohesion 15kPa --residual-cohesion "$kind" --cell 1 --falls 12 --threads 1 \
    --out "$work/$kind" >"$work/log" || exit 1
done
awk -v hard="$(value "$work/15kPa" runout)" -v soft="$(value "$work/4kPa" runout)" \
  'BEGIN { exit !(soft > hard + 2 && hard >= 0) }' || fail "the run-out of a strength that softens"
exit 0
