#!/bin/sh
# footing.sh DIRECTORY: mps-footing --quasi-static bears what slow loading does without its inertia,
# in fewer steps; and a run that goes on from a checkpoint is the whole run.
. "$(dirname "$0")/checks.sh"

value() { sed -n "s/^ *\"$2\": \([^,]*\),*$/\1/p" "$1/summary.json"; }

# 0.25 and 0.5 mm/s tell the capacity at no speed, by the rounded edges that the program takes in quasi-static loading.
for rate in 0.25 0.5; do
  "$1/mps-footing" --rate "${rate}mm/s" --inset 0 --soil 2x1.2 --threads 1 --out "$work/$rate" >/dev/null
done
"$1/mps-footing" --quasi-static --soil 2x1.2 --threads 1 --checkpoint "$work/stop.h5" \
  --out "$work/whole" >"$work/log" || exit 1
if ! awk -v q="$(value "$work/whole" q_over_c)" -v a="$(value "$work/0.25" q_over_c)" \
  -v b="$(value "$work/0.5" q_over_c)" -v n="$(value "$work/whole" steps)" \
  -v m="$(value "$work/0.5" steps)" \
  'BEGIN { slow = 2 * a - b; exit !(q > 0.99 * slow && q < 1.01 * slow && 1.5 * n < m) }'; then
  fail "quasi-static capacity against slow loading, or too many steps"
fi
"$1/mps-footing" --quasi-static --soil 2x1.2 --threads 2 --restart "$work/stop.h5" \
  --out "$work/rest" >/dev/null
cmp "$work/whole/pressure.csv" "$work/rest/pressure.csv" || fail "the run that went on"
"$1/mps-footing" --soil 2x1.2 --restart "$work/stop.h5" --out "$work/rest" 2>"$work/log" &&
  fail "a restart with other options"
grep -q "was made with other options" "$work/log" || fail "which option differs"
# Strength that grows by 4 c/B: characteristics have 7.819.
"$1/mps-footing" --strength-gradient 40kPa/m --soil 2x1 --settlement 0.3mm --threads 1 --out "$work/grows" >"$work/log"
has "$work/log" "characteristics"
in_range "$work/grows/summary.json" q_exact 7.818 7.82
in_range "$work/grows/summary.json" q_over_c 7.4 8.4
# A load a fifth of the width off the middle is borne by B - 2 e, and the strip turns to its side; a run that goes on is the whole run.
off="--eccentricity 0.2 --soil 3x1 --rate 5mm/s --flip-time 10ms --settlement 0.4mm"
"$1/mps-footing" $off --threads 1 --checkpoint "$work/off.h5" --out "$work/off" >"$work/log"
has "$work/log" "Meyerhof, B - 2 e"
in_range "$work/off/summary.json" q_exact 3.0849 3.085
in_range "$work/off/summary.json" q_over_c 2.93 3.24
in_range "$work/off/summary.json" turned -0.2 -0.02
"$1/mps-footing" $off --threads 2 --restart "$work/off.h5" --out "$work/off2" >/dev/null
cmp "$work/off/pressure.csv" "$work/off2/pressure.csv" || fail "the eccentric run that went on"
# Ten times the cohesion is borne after ten times the path, by default; a path too short for it is warned of.
"$1/mps-footing" --cohesion 100kPa --quasi-static --cell 0.125 --soil 2x1.25 --threads 1 --out "$work/strong" >"$work/log" 2>&1
in_range "$work/strong/summary.json" q_over_c 5.0 5.5
grep -q warning: "$work/log" && fail "a warning of ground at its capacity"
"$1/mps-footing" --cohesion 100kPa --quasi-static --cell 0.125 --soil 2x1.25 --settlement 0.6mm --threads 1 --out "$work/short" >"$work/log" 2>&1
has "$work/log" "has not reached its bearing capacity"
has "$work/short/summary.json" "has not reached its bearing capacity"
# Ctrl-C while the ground settles.
timeout -s INT 0.6 "$1/mps-footing" --quasi-static --soil 2x1.2 --threads 1 \
  --checkpoint "$work/cut.h5" --out "$work/cut" >/dev/null 2>&1 || true
[ -s "$work/cut.h5" ] || exit 0 # too slow a machine: it had not begun
"$1/mps-footing" --quasi-static --soil 2x1.2 --threads 1 --restart "$work/cut.h5" \
  --out "$work/rest" >/dev/null
cmp "$work/whole/pressure.csv" "$work/rest/pressure.csv" || fail "the run that was interrupted"
exit 0
