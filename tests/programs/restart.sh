#!/bin/sh
# restart.sh DIRECTORY: programs of several samples go on from a checkpoint on the way, on other threads, to
# the tables and the summary of the run that never stopped. Programs whose own tests do not.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
programs=$1

again() { # PROGRAM EVERY OPTION...: EVERY (s) is so long that the last checkpoint is on the way
  program=$1 every=$2
  shift 2
  rm -rf "$work/$program" "$work/$program"-from-*
  "$programs/$program" "$@" --every-checkpoint "$every" --frames 3 --threads 1 --out "$work/$program" >"$work/log"
  [ -f "$work/$program/checkpoint.h5" ] || return 0 # built without HDF5
  "$programs/$program" "$@" --restart "$work/$program/checkpoint.h5" --frames 3 --threads 2 \
    --out "$work/$program" >"$work/log"
  on=$(sed -n 's/^Results go to //p' "$work/log")
  for file in "$work/$program"/*.csv "$work/$program/summary.json"; do
    cmp "$file" "$on/$(basename "$file")" || fail "another $(basename "$file") after a restart, $program"
  done
}
again mps-sliding-box 0.7 --cell 0.1 --young 5kPa --density 10
again mps-rolling-disc 8ms --cell 0.025 --duration 20ms
again mps-column-collapse 12ms --width 0.1 --cell 0.025 --falls 0.2 --compare
again mps-penetrometer 3ms --soil 0.4x0.4x0.2 --cell 0.025 --depth 1cm --rate 2 --ppc 1 --also-axisymmetric
again mps-consolidation 1 --cell 0.2 --water-stiffness 10 --times 0.05,0.1,0.2
again mps-consolidation 0.2 --cell 0.2 --water-stiffness 10 --layers "$(dirname "$0")/data/consolidation_layers.csv" --drainage both \
  --times 0.01,0.02,0.04
again mps-consolidation 0.7 --cell 0.2 --water-stiffness 10 --case mcc --scheme implicit --loads 100kPa,200kPa --load-ramp 0.02 \
  --times 0.03,0.1
again mps-slope 0.15 --cell 2 --factor-tolerance 0.5
again mps-slope 0.15 --cell 2 --factor-tolerance 0.5 --water-level 0 --drawdown 8
printf 'thickness_m, density_kg_m3, vs_m_s, law, phi_degrees, relative_density\n4, 1900, 100, cyclicsand, 33, 0.4\ninf, 2000, 300\n' \
  >"$work/layers"
again mps-site-response 0.7 --layers "$work/layers" --permeability 1e-4 --frequency 4 --max-frequency 5 --loop 2 --duration 1
again mps-wall 0.05 --cell 0.2 --below-toe 0.4 --travel 2mm --friction 0.3
again mps-wall 0.05 --cell 0.125 --travel 2mm --layers "$(dirname "$0")/data/wall_layers.csv" --water-table 0.4
# Files that have changed since the checkpoint.
changed() { # PROGRAM EVERY FILE EDIT OPTION...: FILE is changed by sed EDIT
  program=$1 every=$2 file=$3 edit=$4
  shift 4
  rm -rf "$work/$program" "$work/$program"-from-*
  "$programs/$program" "$@" --every-checkpoint "$every" --threads 1 --out "$work/$program" >"$work/log"
  [ -f "$work/$program/checkpoint.h5" ] || return 0
  sed -i "$edit" "$file"
  ! "$programs/$program" "$@" --restart "$work/$program/checkpoint.h5" --threads 1 --out "$work/other" >"$work/log" 2>&1 ||
    fail "$program goes on with another file"
  grep -q "changed since the checkpoint" "$work/log" || fail "no word of the file: $(cat "$work/log")"
}
cp "$(dirname "$0")/data/wall_layers.csv" "$work/wall.csv"
changed mps-wall 0.05 "$work/wall.csv" s/1900/1901/ --cell 0.125 --travel 2mm --layers "$work/wall.csv"
cp "$(dirname "$0")/data/consolidation_layers.csv" "$work/column.csv"
changed mps-consolidation 0.2 "$work/column.csv" s/1e-/2e-/ --cell 0.2 --water-stiffness 10 --layers "$work/column.csv" --times 0.01,0.02
printf '0,8\n15,0\n' >"$work/line.csv"
changed mps-slope 0.15 "$work/line.csv" s/15,0/15,1/ --cell 2 --factor-tolerance 0.5 --water-level "$work/line.csv"
again mps-footing 8ms --cell 0.25 --soil 3x1 --settlement 1mm --rate 100mm/s
again mps-footing 0.3 --cell 0.25 --soil 3x1 --young 20MPa
