#!/bin/sh
# resonance_long.sh DIRECTORY: a wall on a spring in waves at .8 to 1.2 of its own frequency: amplitude
# and phase of linear potential flow in the same tank. The waves lose 2 % on their way.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
value() { sed -n "s/^ *\"$1\": \([^,]*\),*$/\1/p" "$work/$ratio/summary.json"; }
for ratio in 0.8 0.9 1 1.1 1.2; do
  "$1/mps-tank" --case resonance --frequency-ratio $ratio --threads 1 --frames 0 --out "$work/$ratio" >"$work/log"
  exact=$(value deflection_exact)
  phase=$(value phase_exact)
  in_range "$work/$ratio/summary.json" deflection "$(awk "BEGIN { print 0.95 * $exact }")" \
    "$(awk "BEGIN { print 1.01 * $exact }")"
  in_range "$work/$ratio/summary.json" phase "$(awk "BEGIN { print $phase - 3 }")" \
    "$(awk "BEGIN { print $phase + 3 }")"
done

# An elastic wall near its own frequency, coupled both ways: first harmonic of the crest from 5 to 9 s. The
# references are Timoshenko beams (four modes) in linear potential flow of the closed tank.
[ -x "$1/mps-seawall" ] || exit 0
for case in "6.3e5 0.007869" "7.8e5 0.009954" "9.6e5 0.006729"; do
  young=${case% *}
  crest=${case#* }
  "$1/mps-seawall" --coupled --length 3 --spacing 0.02 --wall-height 0.4 --young "$young" --amplitude 0.003 \
    --ramp 1 --dt 0.002 --duration 9 --frames 0 --threads 1 --out "$work/elastic" >"$work/log"
  awk -F, -v want="$crest" 'NR == 1 { for (i = 1; i <= NF; i++) if ($i == "deflection_m") column = i }
    NR > 1 && $1 > 5 { w = 6.283185307 * $1; c += $column * cos(w); s += $column * sin(w); n++ }
    END { x = 2 * sqrt(c * c + s * s) / n; print "crest " x " m, theory " want
          exit !(x > 0.94 * want && x < 1.02 * want) }' "$work/elastic/force.csv" || fail "crest, E $young"
done
