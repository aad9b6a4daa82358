# runs.sh - what the scripts here share, to be read after checks.sh: a run on ranks that a signal ends, and
# what it says. Every wait has a limit. Expects mpirun and work; what a run writes is in $work/log.

# one PROGRAM TEXT: of the program there is one line (mpirun writes more), with the text.
one() {
  [ "$(grep -c "^$1: " "$work/log")" -eq 1 ] || fail "not one line with \"$2\": $(cat "$work/log")"
  grep "^$1: " "$work/log" | grep -qF -- "$2" || fail "no \"$2\" in $(cat "$work/log")"
}
# begin RANKS CHECKPOINT PROGRAM OPTION...: starts a run, and waits for its first checkpoint, which may also
# be that of a run that has ended; sets pid.
begin() {
  ranks=$1 checkpoint=$2
  shift 2
  # shellcheck disable=SC2086
  $mpirun -n "$ranks" "$@" >"$work/out" 2>"$work/log" &
  pid=$! tries=0
  until [ -e "$checkpoint" ]; do
    sleep 0.05
    tries=$((tries + 1))
    [ $tries -lt 24000 ] && kill -0 $pid 2>/dev/null || [ -e "$checkpoint" ] ||
      fail "no checkpoint: $(cat "$work/log")"
  done
}
# last_rank: the process of the last rank of the run under way, which has its checkpoint's name.
last_rank() {
  pgrep -f -- "$checkpoint" | tail -n 1
}
# end: waits for the run, twenty minutes at most, and sets code.
end() {
  (sleep 1200 && ps -ef >"$work/late" && kill -KILL $pid) >/dev/null 2>&1 & # ctest waits for who has stdout
  watchdog=$!
  code=0
  wait $pid || code=$?
  kill $watchdog 2>/dev/null || true
  [ ! -e "$work/late" ] || fail "mpirun went on: $(cat "$work/log"; grep mpirun "$work/late")"
}
