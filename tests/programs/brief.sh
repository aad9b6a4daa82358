#!/bin/sh
# brief.sh DIRECTORY: every program for a few steps, to the end and with all its results. The sanitized
# builds run this, where the other tests of programs would take too long (tests/programs/CMakeLists.txt).
. "$(dirname "$0")/checks.sh"
run() { # run PROGRAM OPTIONS...: it ends well and writes a summary of numbers
  program=$1
  [ -x "$programs/$program" ] || return 0
  shift
  "$programs/$program" "$@" --out "$work/$program" >"$work/log" 2>&1 ||
    { cat "$work/log" >&2; fail "$program $*"; }
  grep -q '[0-9]' "$work/$program/summary.json" || fail "$program: no number in summary.json"
  ! grep -qiE 'nan|inf[,} ]' "$work/$program/summary.json" || fail "$program: NaN in summary.json"
  ! grep -qiwE 'nan|inf' "$work/log" || fail "$program: NaN in what it prints"
}
programs=$1
run mps-wave --width 4 --height 10 --duration 0.1 --frames 2
run mps-stability --spacing 2 --method linear
run mps-element --steps 20
run mps-sliding-box --cell 0.1
run mps-rolling-disc --cell 0.02 --duration 0.02
run mps-footing --cell 0.25 --soil 3x1 --settlement 0.05mm
run mps-consolidation --cell 0.3333333333 --water-stiffness 10 --times 0.01
run mps-consolidation --case mandel --cell 0.3333333333 --water-stiffness 10 --times 0.001
run mps-slope --cell 2 --factor 1.5
run mps-slope --runout --cell 2 --phi 0 --cohesion 20kPa --residual-cohesion 5kPa --falls 0.5
printf 'thickness_m, density_kg_m3, vs_m_s, law, phi_degrees, relative_density\n4, 1900, 100, cyclicsand, 33, 0.5\ninf, 2000, 300\n' \
  >"$work/layers"
run mps-site-response --layers "$work/layers" --undrained --max-frequency 5 --duration 0.1
run mps-site-response --layers "$work/layers" --max-frequency 5 --duration 0.2 --loop 2
run mps-wall --cell 0.2 --travel 2mm --rate 0.2
run mps-pile --cell 0.02 --wall-thickness 0.04 --soil 0.4x0.8 --depth 0.01
run mps-penetrometer --soil 0.2x0.2x0.2 --depth 0.002
run mps-dam-break --width 0.05 --cell 0.005 --duration 0.02
run mps-dam-break --method mps --width 0.05 --spacing 0.01 --duration 0.02
run mps-dam-break --width 0.05 --cell 0.01 --duration 0.0632 # one point of the experiment
run mps-column-collapse --cell 0.02 --falls 0.01
run mps-plate --case hole --spacing 0.1176470588
run mps-cantilever --spacing 0.5
run mps-tank --spacing 0.05 --duration 0.05
run mps-flume --spacing 0.05 --length 2 --duration 0.05 --frames 2
run mps-flume --waves jonswap --wall slope --spacing 0.05 --length 2 --duration 0.05
run mps-seawall --duration 0.01
