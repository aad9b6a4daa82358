#!/bin/sh
# cone_long.sh DIRECTORY: cones in clay whose faces end before their edges change little from D/8 to D/16 (minutes).
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"

for angle in 30 60; do
  for cell in 0.0125 0.00625; do
    "$1/mps-penetrometer" --soil 0.6x0.6x0.5 --depth 0.2 --apex-angle $angle --cell $cell \
      --out "$work/$angle/$cell" >/dev/null
    in_range "$work/$angle/$cell/summary.json" particles_inside 0 0
  done
done
in_range "$work/30/0.0125/summary.json" n_factor 3.98 4.15
in_range "$work/30/0.00625/summary.json" n_factor 3.91 4.07 # -1.9 %
in_range "$work/60/0.0125/summary.json" n_factor 6.59 6.73
in_range "$work/60/0.00625/summary.json" n_factor 6.58 6.71 # -0.2 %
