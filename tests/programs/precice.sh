#!/bin/sh
# precice.sh PROGRAM: mps-precice with the tests' stand-in of preCICE: ten windows, each repeated three times.
. "$(dirname "$0")/checks.sh"
cp "$(dirname "$0")/../../programs/precice/precice-config.xml" "$work"
cd "$work"
"$1" --spacing 25mm --dt 8ms --threads 1 --frames 5 --out "$work/flap" >"$work/log" || fail "$(cat "$work/log")"
has "$work/log" "10 time windows, 90 steps, 20 of them repeated"
in_range "$work/flap/summary.json" windows 10 10
in_range "$work/flap/summary.json" windows_repeated 20 20
in_range "$work/flap/summary.json" tip_largest_m 1e-5 1
[ "$(wc -l <"$work/flap/tip.csv")" -eq 11 ] || fail "rows of tip.csv"
for file in flap.vtkhdf flap.xdmf; do [ -s "$work/flap/$file" ] || fail "no $file"; done
status=0
"$1" --bending 2 --out "$work/none" 2>"$work/log" || status=$?
[ $status -eq 2 ] || fail "--bending 2 has exit code $status"
has "$work/log" "--bending is 2"
status=0
"$1" --coupling-mesh Other --spacing 25mm --out "$work/none" 2>"$work/log" >/dev/null || status=$?
[ $status -eq 1 ] || fail "another mesh has exit code $status"
has "$work/log" "mesh 'Other' of the coupling has 0 dimensions, the body has 2"
