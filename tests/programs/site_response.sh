#!/bin/sh
# site_response.sh DIRECTORY: mps-site-response against the waves of a layer on a half space and on a rigid base (Kramer
# 1996), against the backbone and the loops of Hardin and Drnevich's soil by Masing's rules, and of saturated sand that
# liquefies, and does not below the threshold of its strains; units of records; a restart of other layers.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
program=$1/mps-site-response

# A layer of 12 m and 120 m/s on a half space of four times its impedance.
printf 'thickness=12m density=1.8t/m3 vs=120m/s # soft\nhalfspace density=1800 vs=480\n' >"$work/soft"
"$program" --layers "$work/soft" --frequency 4 --duration 10 --threads 1 --out "$work/wave" >"$work/log" || exit 1
in_range "$work/wave/summary.json" amplification_error 0 0.05
in_range "$work/wave/summary.json" settlement -1e-6 1e-6 # the base carries the weight
# The whole table of frequencies against 1/sqrt(cos^2 kH + a^2 sin^2 kH), away from the peaks, where the curve is
# not smoothed.
awk -F, 'NR > 1 { x = 6.283185307 * $1 * 12 / 120; c = cos(x) ^ 2; exact = 1 / sqrt(c + (1 - c) / 16)
  if (exact < 2 && (off = $2 / exact - 1) ^ 2 > worst) { worst = off ^ 2 } if (exact < 2) count++ }
  END { print "within " 100 * sqrt(worst) " % at " count " frequencies"; exit !(count > 10 && worst < 0.06 ^ 2) }' \
  "$work/wave/amplification.csv" || fail "amplification of a layer"
picture "$work/wave/surface.png" 1100x900
picture "$work/wave/profile.png" 1100x700
# On a rigid base the surface of a layer that is shaken far below its frequency moves as 1/cos(kH).
printf 'thickness=12m density=1800 vs=120\n' >"$work/bare"
"$program" --layers "$work/bare" --base rigid --record sine --frequency 0.5 --cycles 4 --max-frequency 5 --threads 1 \
  --out "$work/rigid" >"$work/log" || exit 1
in_range "$work/rigid/summary.json" peak_acceleration 1.045 1.065 # 1/cos(0.1 pi) = 1.0515

# Spectra of 25 cycles of 2 Hz near resonance: 1/sqrt((1 - r^2)^2 + (2 h r)^2), r = T/0.5 s, h = 0.05.
"$program" --layers "$work/bare" --base rigid --record sine --frequency 2 --cycles 25 --acceleration 0.5 --max-frequency 2 \
  --threads 1 --out "$work/sine" >"$work/log" || exit 1
awk -F, 'NR > 1 && $1 > 0.48 && $1 < 0.51 { r = 2 * $1; exact = 0.5 / sqrt((1 - r * r) ^ 2 + (0.1 * r) ^ 2)
  print "period " $1 ": " $3 " of " exact; count++; if (($3 / exact - 1) ^ 2 > 0.02 ^ 2) wrong = 1 }
  END { exit wrong || count < 2 }' "$work/sine/spectrum.csv" || fail "response spectrum of a sine"

# Soil by Hardin and Drnevich: G0 = 40.5 MPa, gamma_r = 0.05 %.
printf 'thickness=10m density=1800 vs=150 law=smallstrain reference-strain=5e-4\nhalfspace density=2200 vs=600\n' \
  >"$work/soil"
"$program" --layers "$work/soil" --record sine --frequency 2 --cycles 5 --loop 8 --threads 1 --out "$work/soil.d" \
  >"$work/log" || exit 1
awk -F, -v G=40.5e6 -v r=5e-4 '
  NR == 1 { next }
  { g[NR] = $2; t[NR] = $3 }
  $2 < 0 && !turned { if (-$2 < -last) turned = 1; else if (-$2 > 0.02 * r) {
    off = $3 / (G * $2 / (1 - $2 / r)) - 1; if (off ^ 2 > worst) worst = off ^ 2; rows++ } last = $2 }
  END { # the last whole cycle of full amplitude: samples 400 to 500 of 100 a cycle
    for (k = 502; k < 602; k++) { area += 0.5 * (t[k] + t[k + 1]) * (g[k + 1] - g[k])
      if (g[k] > high) high = g[k]; if (g[k] < low) low = g[k] }
    x = (high - low) / 2 / r
    masing = 8 * G * r * r * (x - log(1 + x) - x * x / 2 / (1 + x))
    print "first loading within " 100 * sqrt(worst) " % of the backbone in " rows " rows; loop over that of Masing " \
      area / masing " at " x " gamma_r"
    exit !(rows > 3 && worst < 0.04 ^ 2 && x > 2 && (area / masing - 1) ^ 2 < 0.02 ^ 2) }' "$work/soil.d/loop.csv" ||
  fail "loops of Hardin and Drnevich's soil"
picture "$work/soil.d/loop.png" 700x600

# Saturated loose sand liquefies; shaken a fiftieth as strongly it stays below the threshold strain of 0.01 %.
printf 'thickness=5m density=1.9t/m3 vs=120m/s law=cyclicsand phi=33deg relative-density=40%% k0=0.5\n' |
  sed 's/40%/0.4/' >"$work/sand"
sand="--layers $work/sand --base rigid --record sine --frequency 2 --cycles 6 --max-frequency 4 --threads 1"
"$program" $sand --permeability 0.1mm/s --acceleration 1 --loop 2.5 --duration 5 --out "$work/wet" >"$work/log" || exit 1
in_range "$work/wet/summary.json" ru 0.95 1.3
in_range "$work/wet/summary.json" settlement -1e-2 1e-2 # less than k t = 0.5 mm of water can leave: uncertain, and said
grep -q '"settlement_reason": "liquefied sand' "$work/wet/summary.json" || fail "no word of the settlement of liquefied sand"
"$program" $sand --undrained --acceleration 0.02 --out "$work/weak" >"$work/log" || exit 1
in_range "$work/weak/summary.json" ru -0.02 0.02

# Undrained ground on two grids.
printf 'thickness=10m density=2t/m3 vs=200 poisson=0.3\nhalfspace density=2.2t/m3 vs=600\n' >"$work/full"
for h in 1 0.5; do
  "$program" --layers "$work/full" --undrained --record sine --acceleration 0.1 --cycles 1 --cell $h --duration 1.2 --threads 1 \
    --out "$work/full.$h" >"$work/log" || exit 1
done
peak=$(sed -n 's/.*"peak_acceleration": *\([0-9.e-]*\).*/\1/p' "$work/full.1/summary.json" | head -n 1)
in_range "$work/full.0.5/summary.json" peak_acceleration "$(awk -v p="$peak" 'BEGIN { print 0.98 * p }')" \
  "$(awk -v p="$peak" 'BEGIN { print 1.02 * p }')"

# A record in g is that in m/s2.
awk 'BEGIN { for (k = 0; k <= 100; k++) { x = k / 100; printf "%g,%.12g\n", x, sin(62.83185307 * x) * x * (1 - x) } }' \
  >"$work/si.csv"
awk -F, '{ printf "%s,%.15g\n", $1, $2 / 9.80665 }' "$work/si.csv" >"$work/g.csv"
for unit in si g; do
  choice=m/s2
  [ $unit = g ] && choice=g
  "$program" --layers "$work/bare" --base rigid --record "$work/$unit.csv" --record-unit $choice --max-frequency 5 \
    --duration 1 --threads 1 --out "$work/$unit" >"$work/log" || exit 1
done
has "$work/log" "g.csv: CSV, 101 values, step 0.01 s, length 1 s, peak"
has "$work/g/summary.json" '"record_unit": "g"'
{ echo 'acc [g];time [ms]'; awk -F, '{ printf "%.15g;%g\n", $2, 1000 * $1 }' "$work/g.csv"; } >"$work/named.csv"
"$program" --layers "$work/bare" --base rigid --record "$work/named.csv" --max-frequency 5 --duration 1 --threads 1 \
  --out "$work/named" >"$work/log" || exit 1
is "$work/named/surface.csv" acceleration_m_s2 100 \
  "$(awk -F, 'NR == 101 { print $2 }' "$work/si/surface.csv")" 1e-9
is "$work/g/surface.csv" acceleration_m_s2 100 \
  "$(awk -F, 'NR == 101 { print $2 }' "$work/si/surface.csv")" 1e-9

# Layers that have changed since the checkpoint.
if [ -f "$work/si/checkpoint.h5" ]; then
  sed -i 's/120/121/' "$work/bare"
  ! "$program" --layers "$work/bare" --base rigid --record "$work/si.csv" --record-unit m/s2 --max-frequency 5 --duration 1 \
    --threads 1 --restart "$work/si/checkpoint.h5" --out "$work/other" >"$work/log" 2>&1 || fail "other layers"
  has "$work/log" "the layers or the record have changed"
fi

# Numbers of water in dry ground, and a run that ends before its record.
! "$program" --layers "$work/soft" --water-bulk 1GPa --threads 1 --out "$work/no" >"$work/log" 2>&1 || fail "water in dry ground"
has "$work/log" "--porosity and --water-bulk are for ground with water"
"$program" --layers "$work/soft" --max-frequency 5 --duration 0.3 --threads 1 --out "$work/part" >"$work/log" 2>&1 || exit 1
has "$work/log" "--duration is 0.3 s, the record lasts 1.75658 s"

# What is wrong with a file of layers, and where.
wrong() { # TEXT LINE...
  text=$1
  shift
  printf '%s\n' "$@" >"$work/wrong"
  ! "$program" --layers "$work/wrong" --base rigid --threads 1 --out "$work/no" >"$work/log" 2>&1 || fail "no error: $*"
  has "$work/log" "$text"
  [ "$(wc -l <"$work/log")" -eq 1 ] || fail "more than one line: $(cat "$work/log")"
}
good="thickness=5m density=1800 vs=100"
wrong "wrong:1: thickness=0m, must be above 0" "thickness=0m density=1800 vs=100"
wrong 'wrong:2: elastic has no "coesion", only thickness' "$good" "$good coesion=3"
wrong "density=nan is not a finite number" "thickness=5m density=nan vs=100"
wrong "density=18kN/m3 has another unit" "thickness=5m density=18kN/m3 vs=100"
wrong "elastic lacks density" "thickness=5m vs=100"
wrong "law=sand is not one of" "$good law=sand"
wrong "thickness is given twice" "$good thickness=5m"
wrong "law is given twice" "$good law=elastic law=mohrcoulomb phi=30"
wrong "is no name=value" "5 1800 100"
wrong "must be 0.7041 to 1.42: give k0" "$good law=mohrcoulomb phi=10"
wrong "needs one of relative-density and blow-count" "$good law=cyclicsand phi=30"
wrong "needs a strength" "$good law=smallstrain reference-strain=1e-3 curvature=0.9"
wrong "must be at least a cell" "thickness=10cm density=1800 vs=100" "$good"
wrong "a half space, which --base rigid does not have" "$good" "halfspace density=2200 vs=600"
wrong "no layer in the file" "# nothing"
wrong "no permeability, which other layers have" "$good permeability=1e-5" "$good"
record() { # TEXT LINE...
  text=$1
  shift
  printf '%s\n' "$@" >"$work/record"
  ! "$program" --layers "$work/soft" --record "$work/record" --threads 1 --out "$work/no" >"$work/log" 2>&1 ||
    fail "no error: $*"
  has "$work/log" "$text"
}
record "does not come after" 0,0 0.2,1 0.1,2
record "which is not a number" 0,0 0.1,nan 0.2,0
record "at least 2 are needed" 0,0
record "must be at least 4 times --sample" 0,0 0.002,1 0.004,0
record "the acceleration is 0 m/s2 throughout" 0,0 1,0 2,0
