#!/bin/sh
# failures.sh DIRECTORY MPIRUN...: what ends early on several ranks, of a program of each solver but that
# of mps-wave (programs.sh): a table that cannot be written, ranks that were given different things, one that
# dies, one that is asked to stop. One message, an exit status, and the state kept; every wait has a limit.
. "$(dirname "$0")/../programs/checks.sh"
programs=$1
shift
mpirun=$*
. "$(dirname "$0")/runs.sh"
pile="--soil 0.6x0.6 --wall-thickness 0.08 --inner-diameter 0.32 --frames 1"

# wrong WHAT COMMAND...: mpirun must fail, in time.
wrong() {
  what=$1 code=0
  shift
  # shellcheck disable=SC2086
  timeout 1200 $mpirun "$@" >/dev/null 2>"$work/log" || code=$?
  [ $code -ne 0 ] && [ $code -ne 124 ] || fail "$what: exit status $code"
}
# ends NAME TABLE OPTION VALUE OTHER OPTION...: a run of the program that is short.
ends() {
  name=$1 table=$2 option=$3 value=$4 other=$5
  shift 5
  program=$programs/$name
  mkdir -p "$work/$name/$table"
  wrong "a table that rank 0 cannot put in its place" -n 2 "$program" $option $value "$@" --out "$work/$name"
  one "$name" "$table: Is a directory"
  wrong "different ranks" -n 1 "$program" $option $value "$@" --out "$work/$name-d" : \
    -n 1 "$program" $option $other "$@" --out "$work/$name-d"
  one "$name" "all ranks must be given the same options"
  # shellcheck disable=SC2016
  wrong "dead at once" -n 1 "$program" $option $value "$@" --out "$work/$name-k" : \
    -n 1 sh -c 'kill -KILL $$'
}
ends mps-tank force.csv --spacing 0.01 0.02 --duration 0.02 --frames 0
# shellcheck disable=SC2086
ends mps-pile load.csv --cell 0.04 0.05 $pile --depth 0.01 --rate 0.5
[ ! -x "$programs/mps-cantilever" ] || ends mps-cantilever deflection.csv --length 3.6666666667 1.8888888889 --height 2 --spacing 0.2222222222

# signals SIGNAL: sends it to the last rank and waits for the run, which must not end well.
signals() {
  kill "-$1" "$(last_rank)"
  end
  [ $code -ne 0 ] || fail "exit status 0 after $1"
}
# stops PROGRAM OPTION...: asked to stop, it keeps its results and its state, with which others go on; a
# rank that dies ends the run, and the last state goes on too.
stops() {
  name=$1 directory=$work/$1-long
  shift
  begin 2 "$work/$name.h5" "$programs/$name" "$@" --checkpoint "$work/$name.h5" --out "$directory"
  signals TERM
  one "$name" "interrupted at t"
  ! grep -q "the results end there" "$work/log" || has "$directory/summary.json" '"outcome": "interrupted"'
  for signal in KILL TERM; do
    before=$checkpoint
    next=$work/$name-$signal.h5
    begin 3 "$next" "$programs/$name" "$@" --checkpoint "$next" --restart "$before" --out "$directory"
    signals $signal
  done
  one "$name" "interrupted at t"
}
stops mps-tank --spacing 0.01 --duration 1000 --sample 0.01 --every-checkpoint 0.01 --frames 0
# shellcheck disable=SC2086
stops mps-pile $pile --cell 0.04 --depth 0.06 --rate 1e-4 --every-checkpoint 0.01
