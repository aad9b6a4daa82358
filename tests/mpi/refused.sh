#!/bin/sh
# refused.sh PROGRAM MPIRUN...: of two ranks that solve together by PETSc one is refused an allocation
# there. Both report the error, or one line says that all are ended; none hangs.
. "$(dirname "$0")/../examples/checks.sh"
program=$1
shift
mpirun=$*
export PETSC_OPTIONS="-mps_patience 1"
for number in 1 40 700; do
  code=0
  # shellcheck disable=SC2086
  timeout 60 $mpirun -n 2 "$program" $number >"$work/out" 2>"$work/log" || code=$?
  case $code in
  0) has "$work/out" "refused: " ;;
  3) fail "allocation $number was not made: take smaller ones" ;;
  124) fail "allocation $number: the ranks hang" ;;
  *) [ "$(grep -c "^libmps-petsc: rank 1: PETSc has failed here" "$work/log")" -eq 1 ] ||
    fail "allocation $number ends with $code: $(cat "$work/log")" ;;
  esac
  echo "allocation $number: $code"
done
