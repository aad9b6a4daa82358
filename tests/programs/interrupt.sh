#!/bin/sh
# interrupt.sh DIRECTORY: Ctrl-C in every program: one line that says so, the results so far in whole
# files and pictures within 3 s of processor time, exit code 130.
. "$(dirname "$0")/checks.sh"
ulimit -t 60 # s of processor time: what does not stop is stopped
programs=$1

# stop: presses Ctrl-C and waits for $pid, which may use 3 s of the processor until it has ended. The
# same press may come twice, from the terminal and from a program between.
stop() {
  before=$(processor_time)
  kill -INT "$pid" 2>/dev/null || :
  kill -INT "$pid" 2>/dev/null || :
  while now=$(processor_time) && [ -n "$now" ]; do
    [ $((now - ${before:-now})) -le 300 ] || fail "$program: more than 3 s after Ctrl-C"
    sleep 0.02
  done
  status=0
  wait "$pid" || status=$?
  [ "$status" -eq 130 ] || fail "$program: exit code $status: $(cat "$work/log")"
  [ "$(wc -l <"$work/log")" -eq 1 ] || fail "$program: more than one line: $(cat "$work/log")"
  has "$work/log" "${program%% *}: interrupted"
}

# interrupt NAME SECONDS PROGRAM OPTION...: runs into $work/NAME and presses Ctrl-C so long after the
# run has begun (twice as late where there was no result yet, up to six times).
interrupt() {
  name=$1
  wait=$2
  program=$3
  shift 3
  for try in 1 2 3 4 5 6; do
    rm -rf "$work/$name"
    "$programs/$program" "$@" --threads 1 --out "$work/$name" >"$work/out" 2>"$work/log" &
    pid=$!
    until [ -s "$work/out" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.05; done
    used "$wait"
    stop
    grep -q "no results yet" "$work/log" || return 0
    wait=$(awk "BEGIN { print 2 * $wait }")
  done
  fail "$program: no results after $wait s"
}

# wrote NAME FILE...: these are there and named on stdout; no temporary file is left, all pictures
# are whole, and summary.json says how the run ended.
wrote() {
  directory=$work/$1
  shift
  for file; do
    [ -s "$directory/$file" ] || fail "no $file in $(ls "$directory")"
    has "$work/out" "$file"
  done
  has "$directory/summary.json" '"outcome": "interrupted"'
  [ -z "$(find "$directory" -name '*.part')" ] || fail "temporary files are left"
  for file in "$directory"/*.png; do
    [ ! -e "$file" ] || picture "$file" 0x0
  done
}

interrupt box 0.5 mps-sliding-box --cell 0.0025
wrote box forces.csv summary.json
interrupt disc 0.5 mps-rolling-disc --cell 0.002
wrote disc motion.csv summary.json
has "$work/disc/summary.json" '"x_error_05": null'
interrupt footing 1 mps-footing --cell 0.025
wrote footing pressure.csv particles.csv summary.json
interrupt slope 1 mps-slope --cell 0.5
wrote slope motion.csv particles.csv summary.json
printf 'thickness_m, density_kg_m3, vs_m_s\n20, 1900, 150\n' >"$work/layers"
interrupt site 1 mps-site-response --layers "$work/layers" --base rigid --duration 1000
wrote site surface.csv spectrum.csv amplification.csv profile.csv summary.json
interrupt wall 1 mps-wall --pressure passive
wrote wall pressure.csv particles.csv summary.json
interrupt layer 1 mps-consolidation --cell 0.025 --times 0.0001,0.0002,0.0003,10
wrote layer profile.csv times.csv summary.json
interrupt pile 1 mps-pile --depth 1 --soil 0.4x2
wrote pile load.csv summary.json
interrupt dam 1 mps-dam-break
wrote dam front.csv particles.csv summary.json
interrupt collapse 1 mps-column-collapse --compare
wrote collapse cases.csv front_sand.csv particles_sand.csv summary.json
has "$work/out" "before its end"
for key in runout runout_error runout_98 runout_end height time_at_rest; do
  has "$work/collapse/summary.json" "\"$key\": null"
done
interrupt cone 2 mps-penetrometer --symmetry quarter --soil 0.3x0.3x0.3
wrote cone force.csv section.csv summary.json
interrupt wave 0.5 mps-wave --spacing 2 --duration 3000
wrote wave receivers.csv summary.json

interrupt tank 1 mps-tank --duration 100
wrote tank summary.json
interrupt dam-mps 0.5 mps-dam-break --method mps
wrote dam-mps front.csv particles.csv summary.json
interrupt flume 1 mps-flume --duration 100
wrote flume gauges.csv force.csv summary.json
if [ -x "$programs/mps-seawall" ]; then
  interrupt seawall 1 mps-seawall
  wrote seawall force.csv summary.json
  # the crest of so long a wave is looked for where there are samples, not at all steps before them
  interrupt long 0.5 mps-seawall --period 1e6 --amplitude 0
  wrote long force.csv summary.json
fi

# Pressed again and again: it ends, and says so.
rm -f "$work/out"
"$programs/mps-tank" --duration 100 --threads 1 --out "$work/again" >"$work/out" 2>"$work/log" &
pid=$!
until [ -s "$work/out" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.05; done
for press in 1 2 3 4 5 6; do
  kill -INT "$pid" 2>/dev/null || :
  sleep 0.002
done
status=0
wait "$pid" || status=$?
[ "$status" -eq 130 ] || fail "mps-tank: exit code $status: $(cat "$work/log")"
has "$work/log" "mps-tank: "
[ "$(wc -l <"$work/log")" -le 2 ] || fail "mps-tank: $(cat "$work/log")"

# Above the ground there is nothing to scale the axes of a picture by.
program=mps-penetrometer
"$programs/"$program --symmetry quarter --soil 0.4x0.4x0.2 --cell 0.025 --depth 0.05 --every-checkpoint 0.01 --checkpoint "$work/air.h5" \
  --threads 1 --out "$work/air" >"$work/out" 2>"$work/log" &
pid=$!
until [ -s "$work/air.h5" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.02; done
stop
wrote air force.csv summary.json

# Before there is any result: the program ends at once, and the summary has null for all results.
# early SECONDS COMMAND KEY...: the keys are null
early() {
  rm -rf "$work/early"
  program=$2
  "$programs/"$program --threads 1 --out "$work/early" >"$work/out" 2>"$work/log" &
  pid=$!
  used "$1"
  stop
  has "$work/log" "there are no results yet"
  [ "$(ls "$work/early")" = summary.json ] || fail "$program left $(ls "$work/early")"
  has "$work/early/summary.json" '"outcome": "interrupted"'
  shift 2
  for key; do has "$work/early/summary.json" "\"$key\": null"; done
}
early 0.3 "mps-pile --cell 0.0005 --soil 0.4x3" # being built
early 0.3 "mps-tank --spacing 0.0005"
early 0.3 "mps-wave --spacing 0.04"
early 0.5 "mps-stability --spacing 0.2" dt_linear dt_stepping steps

# The study: the cells of the cases that were not run are empty.
"$programs/mps-stability" --study --method stepping --threads 1 --out "$work/study" >"$work/out" \
  2>"$work/log" &
pid=$!
used 2
kill -INT "$pid"
status=0
wait "$pid" || status=$?
[ "$status" -eq 130 ] || fail "mps-stability: exit code $status: $(cat "$work/log")"
has "$work/log" "mps-stability: interrupted: limits.csv"
has "$work/study/summary.json" '"outcome": "interrupted"'
[ "$(wc -l <"$work/study/limits.csv")" -eq 321 ] || fail "limits.csv"

# No hook reaches into a factorisation.
[ -x "$programs/mps-cantilever" ] || exit 0
early 1 "mps-cantilever --height 2 --spacing 0.004987531172 --length 3.992518703" tip tip_error unknowns
early 1 "mps-plate --spacing 0.002" end_displacement particles
program="mps-cantilever --height 2 --spacing 0.03921568627 --length 15.70588235 --convergence"
"$programs/"$program --threads 1 --out "$work/beam" >"$work/out" 2>"$work/log" &
pid=$!
until [ -s "$work/beam/shape.gp" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.05; done
used 0.5
stop
has "$work/log" "written so far: deflection.csv"
has "$work/beam/summary.json" '"outcome": "interrupted"'
in_range "$work/beam/summary.json" tip_error -1 1
[ -z "$(find "$work/beam" -name '*.part')" ] || fail "temporary files are left"
