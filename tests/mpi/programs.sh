#!/bin/sh
# programs.sh DIRECTORY MPIRUN...: mps-wave on ranks, as a user starts it: the files of one process,
# one message where it ends early, and the last checkpoint where a rank dies. Every run has a limit.
. "$(dirname "$0")/../programs/checks.sh"
programs=$1
shift
mpirun=$*
. "$(dirname "$0")/runs.sh"
wave=$programs/mps-wave

# on N PROGRAM OPTION...
on() {
  ranks=$1
  shift
  # shellcheck disable=SC2086
  timeout 1200 $mpirun -n "$ranks" "$@"
}
# The same files from 3 ranks as without mpirun; of the frames tests/vtk/same-frames sees that VTK reads them.
model="--spacing 1 --width 40 --height 30 --incline 15,25,15 --sides freefield --courant 0.5"
files="receivers.csv slope.csv peaks.csv summary.json wave.vtkhdf"
# shellcheck disable=SC2086
"$wave" $model --duration 0.1 --frames 2 --out "$work/alone" >"$work/alone.out"
for ranks in 3; do
  # shellcheck disable=SC2086
  on $ranks "$wave" $model --duration 0.1 --frames 2 --out "$work/r$ranks" >"$work/out"
  for file in $files; do
    cmp "$work/alone/$file" "$work/r$ranks/$file" || fail "$file of $ranks ranks"
  done
  sed "s:$work/[a-z0-9]*/::" "$work/alone.out" >"$work/a"
  sed "s:$work/[a-z0-9]*/::" "$work/out" >"$work/b"
  cmp "$work/a" "$work/b" || fail "what $ranks ranks print"
done
python=$(command -v /usr/bin/python3 || command -v python3 || echo false)
code=0
"$python" "$(dirname "$0")/../vtk/same-frames" "$work/alone/wave.vtkhdf" "$work/r3/wave.vtkhdf" ||
  code=$?
[ $code -eq 0 ] || [ $code -eq 77 ] || fail "frames"

# Options: one line.
on 2 "$wave" --freqency 1 2>"$work/log" && fail "an unknown option was taken"
one mps-wave "did you mean --frequency"
[ "$(on 2 "$wave" --help | grep -c "^Usage")" -eq 1 ] || fail "--help of two ranks"

# A step above the limit; divergence; no directory; a file that rank 0 cannot put in its place: the same error on all.
on 3 "$wave" --spacing 2 --dt 0.02 --out "$work/d" >/dev/null 2>"$work/log" && fail "a step above the limit"
one mps-wave "try --dt"
on 3 "$wave" --spacing 2 --integrator euler --dt 2ms --out "$work/d" >/dev/null 2>"$work/log" && fail "divergence"
[ "$(grep -c "unstable: at t = .*the most that was put in" "$work/log")" -eq 1 ] || fail "divergence: $(cat "$work/log")"
on 2 "$wave" --spacing 2 --out /dev/full/x >/dev/null 2>"$work/log" && fail "no directory"
one mps-wave "Not a directory"
mkdir -p "$work/f/receivers.csv"
on 2 "$wave" --spacing 2 --duration 0.3 --courant 0.5 --out "$work/f" >/dev/null 2>"$work/log" && fail "a directory"
one mps-wave "receivers.csv: Is a directory"

# Ctrl-C, as mpirun passes it on: one line, the results so far, and the state.
# As many seconds of the model as one process computes in some 10 s, so that the run is under way when it is
# asked to stop, on fast machines too.
begun=$(date +%s%N)
# shellcheck disable=SC2086
"$wave" $model --duration 50 --out "$work/short" >/dev/null
long=$((50 * 10000000 / (($(date +%s%N) - begun) / 1000 + 1)))
[ $long -ge 200 ] || long=200
# begin_wave DIRECTORY: three ranks, until they compute.
begin_wave() {
  # shellcheck disable=SC2086
  begin 3 "$1/checkpoint.h5" "$wave" $model --every-checkpoint 1 --out "$1" --duration $long
}
# goes_on DIRECTORY: from its checkpoint, two ranks come to the results of one process in one go.
# shellcheck disable=SC2086
"$wave" $model --duration $long --out "$work/whole" >/dev/null
goes_on() {
  rm -rf "$work/on"
  # shellcheck disable=SC2086
  on 2 "$wave" $model --duration $long --restart "$1/checkpoint.h5" --out "$work/on" >/dev/null
  for file in receivers.csv slope.csv peaks.csv; do
    cmp "$work/whole/$file" "$work/on/$file" || fail "$file after a restart"
  done
}
# Open MPI waits so long (s) before it asks the ranks to stop, when the run must still be under way, and
# again before it ends them: too soon on a machine that has other things to do, so it gets more then.
for patience in 3 12 25 100; do
  export OMPI_MCA_odls_base_sigkill_timeout=$patience
  rm -rf "$work/cut"
  begin_wave "$work/cut"
  kill -TERM $pid
  end
  grep -q '"outcome": "interrupted"' "$work/cut/summary.json" && break # the last file that it writes
done
one mps-wave "interrupted"
has "$work/cut/summary.json" '"outcome": "interrupted"'
goes_on "$work/cut"

unset OMPI_MCA_odls_base_sigkill_timeout

# A rank that dies ends the run; the last checkpoint goes on.
begin_wave "$work/dead"
victim=$(pgrep -f "$work/dead" | tail -n 1)
kill -KILL "$victim"
end
[ $code -ne 0 ] || fail "a dead rank was not noticed"
goes_on "$work/dead"
