#!/bin/sh
# site_response.sh DIRECTORY: mps-site-response against the waves of a layer on a half space and on a rigid base (Kramer
# 1996), against the backbone and the loops of Hardin and Drnevich's soil by Masing's rules, and of saturated sand that
# liquefies, and does not below the threshold of its strains; units of records; a restart of other layers.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
program=$1/mps-site-response

# A layer of 12 m and 120 m/s on a half space of four times its impedance.
printf 'thickness_m, density_kg_m3, vs_m_s\n12, 1800, 120\ninf, 1800, 480\n' >"$work/soft"
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
# At interfaces of layers shear stresses have no jump, and strains that of the moduli: Haskell's matrices and the transform of
# the wavelet, between rows. edges LAYERS FREQUENCY CELL SPLINE DEPTH=kPa...
edges() {
  "$program" --layers "$work/$1" --frequency "$2" --cell "$3" --spline "$4" --threads 1 --out "$work/edges" >"$work/log" || exit 1
  shift 4
  for edge; do
    awk -F, -v at="${edge%=*}" -v exact="${edge#*=}" '
      NR > 2 && $1 >= at && depth < at { found = 1e-3 * (tau + ($7 - tau) * (at - depth) / ($1 - depth)) }
      NR > 1 { depth = $1; tau = $7 }
      END { print at " m: " found " of " exact " kPa"; exit !((found / exact - 1) ^ 2 < 0.02 ^ 2) }' \
      "$work/edges/profile.csv" || fail "shear stress at interfaces of layers"
  done
}
printf 'thickness_m, density_kg_m3, vs_m_s\n3, 2000, 300\n5, 1700, 120\ninf, 2100, 500\n' >"$work/hard"
printf 'thickness_m, density_kg_m3, vs_m_s\n4, 1750, 150\n7.3, 1900, 240\ninf, 2200, 600\n' >"$work/harder"
for cell in 0.33 0.25 0.2; do
  edges hard 2.5 $cell 3 2.9=11.04 3.1=11.73 7.9=21.95 8.1=22.15
  in_range "$work/edges/summary.json" shear_strain 8.8e-4 9.2e-4 # 9.00e-4 at 8 m
done
edges hard 2.5 0.2 2 2.9=11.04 3.1=11.73 7.9=21.95 8.1=22.15
edges harder 3 0.35 3 3.99=11.97 4.01=12.02 11.29=27.21 11.31=27.24
# On a rigid base the surface of a layer that is shaken far below its frequency moves as 1/cos(kH).
printf 'thickness_m, density_kg_m3, vs_m_s\n12, 1800, 120\n' >"$work/bare"
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
printf 'thickness_m, density_kg_m3, vs_m_s, law, reference_strain\n10, 1800, 150, smallstrain, 0.0005\ninf, 2200, 600\n' \
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
printf 'thickness_m, density_kg_m3, vs_m_s, law, phi_degrees, relative_density, k0\n5, 1900, 120, cyclicsand, 33, 0.4, 0.5\n' >"$work/sand"
sand="--layers $work/sand --base rigid --record sine --frequency 2 --cycles 6 --max-frequency 4 --threads 1"
"$program" $sand --permeability 0.1mm/s --acceleration 1 --loop 2.5 --duration 5 --out "$work/wet" >"$work/log" || exit 1
in_range "$work/wet/summary.json" ru 0.95 1.3
in_range "$work/wet/summary.json" settlement 1e-5 5e-4 # as water leaves, of which k t = 0.5 mm can
in_range "$work/wet/summary.json" settlement_drift -5e-3 5e-3
"$program" $sand --undrained --acceleration 0.02 --out "$work/weak" >"$work/log" || exit 1
in_range "$work/weak/summary.json" ru -0.02 0.02

# Undrained ground on two grids.
printf 'thickness_m, density_kg_m3, vs_m_s, poisson\n10, 2000, 200, 0.3\ninf, 2200, 600\n' >"$work/full"
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
head="thickness_m, density_kg_m3, vs_m_s"
all="$head, law, phi_degrees, reference_strain, curvature, permeability_m_s"
good="5, 1800, 100"
wrong "wrong:2: thickness_m is 0, must be above 0" "$head" "0, 1800, 100"
wrong 'wrong:1: "coesion" is not a column of a layer: thickness_m' "$head, coesion" "$good, 3"
wrong '"nan" is not a finite number' "$head" "5, nan, 100"
wrong 'the unit of "density_kN_m3" is none of density, such as density_kg_m3' "thickness_m, density_kN_m3, vs_m_s" "$good"
wrong "the header lacks density_kg_m3" "thickness_m, vs_m_s" "5, 100"
wrong "density is missing" "$head" "5, , 100"
wrong "law is sand, must be one of elastic|smallstrain" "$all" "$good, sand"
wrong 'a second column "thickness_m"' "$head, thickness_m" "$good, 5"
wrong "too many values" "$head" "$good, 3"
wrong "wrong:1: a header is missing" "$good"
wrong "must be 0.7041 to 1.42" "$all" "$good, mohrcoulomb, 10"
wrong "mohrcoulomb lacks phi" "$all" "$good, mohrcoulomb"
wrong "elastic has no phi" "$all" "$good, , 10"
wrong "needs one of relative_density and blow_count" "$all" "$good, cyclicsand, 30"
wrong "needs a strength" "$all" "$good, smallstrain, , 1e-3, 0.9"
wrong "must be at least a cell" "$head" "0.1, 1800, 100" "$good"
wrong "a half space, of thickness inf, which --base rigid does not have" "$head" "$good" "inf, 2200, 600"
wrong "wrong:3: a layer below one that is endless" "$head" "inf, 2200, 600" "$good"
wrong "no layer above the half space" "$head" "inf, 2200, 600"
wrong "no layer in the file" "# nothing"
wrong "layer 2: no permeability, which other layers have" "$all" "$good, , , , , 1e-5" "$good"
# One file serves several programs: columns of others are passed over.
printf '%s\n' "$head, vp_m_s, damping_ratio, modulus_Pa" "12, 1800, 120, 240, 0.02, 1e6" >"$work/many"
"$program" --layers "$work/many" --base rigid --max-frequency 4 --duration 0.1 --threads 1 --out "$work/many.d" >"$work/log" || exit 1
"$1/mps-wave" --layers "$work/many" --duration 0.01 --threads 1 --out "$work/many.w" >"$work/log" || exit 1
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
