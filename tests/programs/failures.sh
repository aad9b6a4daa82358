#!/bin/sh
# failures.sh DIRECTORY: divergence and a full disk are told clearly, once, and spoil nothing.
. "$(dirname "$0")/checks.sh"
wave=$1/mps-wave

status=0
"$wave" --spacing 2 --dt 0.02 --out "$work/d" >/dev/null 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "a step above the limit: exit code $status"
has "$work/log" "--dt is 0.02 s, must be at most the linear stability limit, "
[ "$(wc -l <"$work/log")" -eq 1 ] || fail "more than an error: $(cat "$work/log")"
# Euler's motion grows at any step: beyond what the pulse puts in, or beyond all bounds.
status=0
"$wave" --spacing 2 --integrator euler --dt 2ms --out "$work/d" >/dev/null 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "divergence: exit code $status"
has "$work/log" "warning: Euler without damping"
[ "$(grep -v "warning: Euler" "$work/log" | grep -c "unstable: at t = .*the most that was put in.*--integrator verlet")" -eq 1 ] ||
  fail "divergence: $(cat "$work/log")"
[ "$(wc -l <"$work/log")" -eq 2 ] || fail "more than a warning and an error: $(cat "$work/log")"
has "$work/d/summary.json" '"outcome": "diverged"'
has "$work/d/summary.json" '"surface_peak": null'

# A full disk: the older result stays.
mkdir "$work/f"
echo "older" >"$work/f/receivers.csv"
status=0
(ulimit -f 8 && "$wave" --spacing 2 --duration 0.3 --courant 0.5 --out "$work/f") >/dev/null 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "full disk: exit code $status"
has "$work/log" "receivers.csv: File too large"
has "$work/f/receivers.csv" "older"
status=0
"$wave" --help >/dev/full 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "--help to a full disk: exit code $status"
status=0
"$1/mps-stability" --spacing 3.2 --method linear --out "$work/s" >/dev/full 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "output to a full disk: exit code $status"

# A picture on a full disk: the table is there, no empty picture is left or announced.
disc="$1/mps-rolling-disc --cell 0.025 --duration 0.05 --threads 1"
if command -v gnuplot >/dev/null; then
  status=0
  (ulimit -f 16 && $disc --out "$work/p") >"$work/out" 2>"$work/log" || status=$?
  [ "$status" -eq 1 ] || fail "picture on a full disk: exit code $status"
  [ "$(grep -vc "no checkpoint is written" "$work/log")" -eq 1 ] || fail "more than one line: $(cat "$work/log")"
  has "$work/log" "mps-rolling-disc: cannot draw $work/p/motion.png: "
  [ ! -e "$work/p/motion.png" ] || fail "a picture is left"
  [ -s "$work/p/motion.csv" ] || fail "no motion.csv"
  if grep -q "motion.png" "$work/out"; then fail "announced: $(cat "$work/out")"; fi
fi
# A limit on the size of files, wherever it strikes: whole files only, and never exit code 0.
for blocks in 1 2 4 8 16; do
  status=0
  (ulimit -f $blocks && $disc --out "$work/l$blocks") >"$work/out" 2>"$work/log" || status=$?
  [ "$status" -eq 1 ] || [ "$status" -eq 0 ] || fail "limit: exit code $status: $(cat "$work/log")"
  # one line of what could not be written, before it one of the checkpoint on the way
  [ "$status" -eq 0 ] || [ "$(grep -vc "no checkpoint is written" "$work/log")" -le 1 ] ||
    fail "lines: $(cat "$work/log")"
  [ "$(wc -l <"$work/log")" -le 2 ] || fail "lines: $(cat "$work/log")"
  [ -z "$(find "$work/l$blocks" -name '*.part')" ] || fail "temporary files are left"
  [ "$status" -eq 0 ] || ! grep -q "Results" "$work/out" || fail "results announced"
  [ ! -e "$work/l$blocks/motion.png" ] || picture "$work/l$blocks/motion.png" 1000x640 1f4e8c c0392b
done
# Checkpoints that cannot be written are told of once, in a run of several models too.
status=0
(ulimit -f 16 && "$1/mps-column-collapse" --compare --cell 0.025 --falls 0.2 --threads 1 --out "$work/c") >"$work/out" \
  2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "no checkpoints: exit code $status: $(cat "$work/log")"
[ "$(grep -c "no checkpoint is written" "$work/log")" -eq 1 ] || fail "lines: $(cat "$work/log")"
