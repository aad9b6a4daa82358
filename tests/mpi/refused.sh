#!/bin/sh
# refused.sh PROGRAM MPIRUN...: of two ranks that solve together by PETSc one is refused an allocation
# there. It gets a status with a record, and so does the other where it does not wait within PETSc;
# libmps-petsc prints nothing and ends no process, and none hangs.
. "$(dirname "$0")/../programs/checks.sh"
program=$1
shift
mpirun=$*
export PETSC_OPTIONS="-mps_patience 1"
for number in 1 40 700; do
  code=0
  # shellcheck disable=SC2086
  timeout 1200 $mpirun -n 2 "$program" $number >"$work/out" 2>"$work/log" || code=$?
  case $code in
  3) fail "allocation $number was not made: take smaller ones" ;;
  4) fail "allocation $number: what holds after an error does not: $(cat "$work/out")" ;;
  124) fail "allocation $number: the ranks hang" ;;
  esac
  has "$work/out" "refused: mps_elastic_solve: "
  ! grep -Eq "libmps|MPI_ABORT|PETSC ERROR" "$work/log" || fail "allocation $number: $(cat "$work/log")"
  echo "allocation $number: $code, $(cat "$work/out")"
done
