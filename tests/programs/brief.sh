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
run mps-stability --radius 1 --method linear
run mps-element --steps 20
run mps-sliding-box --h 0.1
run mps-rolling-disc --h 0.02 --duration 0.02
run mps-footing --h 0.25 --domain 3x1 --settlement 0.05mm
run mps-consolidation --cells 3 --stiffness 10 --times 0.01
run mps-consolidation --case mandel --cells 3 --stiffness 10 --times 0.001
run mps-slope --h 2 --factor 1.5 --falls 0.5
run mps-slope --runout --h 2 --phi 0 --cohesion 20kPa --residual-cohesion 5kPa --falls 0.5
printf 'thickness=4m density=1.9t/m3 vs=100 law=cyclicsand phi=33deg relative-density=0.5\nhalfspace density=2t/m3 vs=300\n' \
  >"$work/layers"
run mps-site-response --layers "$work/layers" --undrained --max-frequency 5 --duration 0.1
run mps-site-response --layers "$work/layers" --max-frequency 5 --duration 0.2 --loop 2
run mps-wall --h 0.2 --path 2mm --rate 0.2
run mps-pile --h 0.02 --wall 0.04 --soil 0.4x0.8 --depth 0.01
run mps-penetrometer --soil 2x2x2 --depth 0.002
run mps-dam-break --base 0.05 --h 0.005 --duration 0.02
run mps-dam-break --method mps --base 0.05 --h 0.01 --duration 0.02
run mps-dam-break --base 0.05 --h 0.01 --duration 0.0632 # one point of the experiment
run mps-column-collapse --h 0.02 --falls 0.01
run mps-plate --case hole --cells 8
run mps-cantilever --ny 4
run mps-tank --spacing 0.05 --duration 0.05
run mps-flume --spacing 0.05 --length 2 --duration 0.05 --frames 2
run mps-flume --waves jonswap --wall slope --spacing 0.05 --length 2 --duration 0.05
run mps-seawall --duration 0.01
