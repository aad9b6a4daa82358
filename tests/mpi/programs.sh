#!/bin/sh
# programs.sh DIRECTORY MPIRUN...: mps-wave on ranks, as a user starts it: the files of one process,
# one message where it ends early, and the last checkpoint where a rank dies. Every run has a limit.
. "$(dirname "$0")/../examples/checks.sh"
programs=$1
shift
mpirun=$*
wave=$programs/mps-wave

# on N PROGRAM OPTION...
on() {
  ranks=$1
  shift
  # shellcheck disable=SC2086
  timeout 100 $mpirun -n "$ranks" "$@"
}
# one FILE PROGRAM TEXT: the program has written one line there (mpirun writes more), with the text.
one() {
  [ "$(grep -c "^$2: " "$1")" -eq 1 ] || fail "not one line with \"$3\": $(cat "$1")"
  grep "^$2: " "$1" | grep -qF -- "$3" || fail "no \"$3\" in $(cat "$1")"
}

# The same files from 3 ranks as without mpirun; frames are compared by tests/vtk/same-frames.
model="--radius 0.5 --width 40 --height 30 --slope 15,25,15 --sides freefield --courant 0.5"
files="receivers.csv slope.csv peaks.csv summary.json"
# shellcheck disable=SC2086
"$wave" $model --duration 0.1 --vtk 0.05 --out "$work/alone" >"$work/alone.out"
for ranks in 3; do
  # shellcheck disable=SC2086
  on $ranks "$wave" $model --duration 0.1 --vtk 0.05 --out "$work/r$ranks" >"$work/out"
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
on 2 "$wave" --raduis 1 2>"$work/log" && fail "an unknown option was taken"
one "$work/log" mps-wave "did you mean --radius"
[ "$(on 2 "$wave" --help | grep -c "^Usage")" -eq 1 ] || fail "--help of two ranks"

# Divergence; no directory; a full disk of rank 0, which writes: the same error on all.
on 3 "$wave" --radius 1 --dt 0.02 --out "$work/d" >/dev/null 2>"$work/log" && fail "divergence"
has "$work/log" "try --dt"
[ "$(grep -c "diverged" "$work/log")" -eq 1 ] || fail "divergence: $(cat "$work/log")"
on 2 "$wave" --radius 1 --out /dev/full/x >/dev/null 2>"$work/log" && fail "no directory"
one "$work/log" mps-wave "Not a directory"
mkdir "$work/f"
ln -s /dev/full "$work/f/receivers.csv.part"
on 2 "$wave" --radius 1 --duration 0.3 --courant 0.5 --out "$work/f" >/dev/null 2>"$work/log" &&
  fail "full disk"
one "$work/log" mps-wave "receivers.csv: No space left on device"

# Ctrl-C, as mpirun passes it on: one line, the results so far, and the state. Open MPI waits so long (s)
# before it asks the ranks to stop, and again before it ends them: the run must still be under way then.
long=400 # s of the model
export OMPI_MCA_odls_base_sigkill_timeout=3
# begin DIRECTORY OPTION...: starts three ranks, and waits until they compute; sets pid.
begin() {
  directory=$1
  shift
  # shellcheck disable=SC2086
  $mpirun -n 3 "$wave" $model --checkpoint 1 --out "$directory" "$@" >"$work/out" 2>"$work/log" &
  pid=$!
  tries=0
  until [ -e "$directory/checkpoint.h5" ]; do
    sleep 0.05
    tries=$((tries + 1))
    [ $tries -lt 800 ] && kill -0 $pid 2>/dev/null || fail "no checkpoint: $(cat "$work/log")"
  done
}
# end: waits for it, a minute at most, and sets code.
end() {
  (sleep 60 && ps -ef >"$work/late" && kill -KILL $pid) >/dev/null 2>&1 & # ctest waits for who has stdout
  watchdog=$!
  code=0
  wait $pid || code=$?
  kill $watchdog 2>/dev/null || true
  [ ! -e "$work/late" ] || fail "mpirun went on: $(cat "$work/log"; grep "mpirun\|mps-wave" "$work/late")"
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
begin "$work/cut" --duration $long
kill -TERM $pid
end
one "$work/log" mps-wave "interrupted"
has "$work/cut/summary.json" '"outcome": "interrupted"'
goes_on "$work/cut"

unset OMPI_MCA_odls_base_sigkill_timeout

# A rank that dies ends the run; the last checkpoint goes on.
begin "$work/dead" --duration $long
victim=$(pgrep -f "$work/dead" | tail -n 1)
kill -KILL "$victim"
end
[ $code -ne 0 ] || fail "a dead rank was not noticed"
goes_on "$work/dead"
