#!/bin/sh
# failures.sh DIRECTORY: divergence, a full disk and Ctrl-C are told clearly and spoil nothing.
. "$(dirname "$0")/checks.sh"
wave=$1/mps-wave

status=0
"$wave" --radius 1 --dt 0.02 --out "$work/d" >/dev/null 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "divergence: exit code $status"
has "$work/log" "warning: dt"
has "$work/log" "diverged at step"
has "$work/log" "try --dt"
has "$work/d/summary.json" '"outcome": "diverged"'
has "$work/d/summary.json" '"surface_peak": null'

# A full disk: the older result stays.
mkdir "$work/f"
echo "older" >"$work/f/receivers.csv"
ln -s /dev/full "$work/f/receivers.csv.part"
status=0
"$wave" --radius 1 --duration 0.3 --courant 0.5 --out "$work/f" >/dev/null 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "full disk: exit code $status"
has "$work/log" "receivers.csv: No space left on device"
has "$work/f/receivers.csv" "older"
status=0
"$wave" --help >/dev/full 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "--help to a full disk: exit code $status"
status=0
"$1/mps-stability" --radius 1.6 --method linear --out "$work/s" >/dev/full 2>"$work/log" || status=$?
[ "$status" -eq 1 ] || fail "output to a full disk: exit code $status"

# Ctrl-C in a run that would take long: what there is gets written.
"$wave" --radius 1 --duration 3000 --out "$work/i" >"$work/out" 2>"$work/log" &
pid=$!
until grep -q "steps" "$work/out"; do sleep 0.1; done
kill -INT "$pid"
status=0
wait "$pid" || status=$?
[ "$status" -eq 130 ] || fail "Ctrl-C: exit code $status"
has "$work/log" "interrupted"
