#!/bin/sh
# resonance_long.sh DIRECTORY: a wall on a spring in waves at .8 to 1.2 of its own frequency: amplitude
# and phase of linear potential flow in the same tank. The waves lose 3.5 % on their way.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
value() { sed -n "s/^ *\"$1\": \([^,]*\),*$/\1/p" "$work/$ratio/summary.json"; }
for ratio in 0.8 0.9 1 1.1 1.2; do
  "$1/mps-tank" --case resonance --ratio $ratio --threads 1 --frames 0 --out "$work/$ratio" >"$work/log"
  exact=$(value deflection_exact)
  phase=$(value phase_exact)
  in_range "$work/$ratio/summary.json" deflection "$(awk "BEGIN { print 0.95 * $exact }")" \
    "$(awk "BEGIN { print 1.01 * $exact }")"
  in_range "$work/$ratio/summary.json" phase "$(awk "BEGIN { print $phase - 3 }")" \
    "$(awk "BEGIN { print $phase + 3 }")"
done
