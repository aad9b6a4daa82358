#!/bin/sh
# restarts.sh DIRECTORY MPIRUN...: runs of several ranks whose last rank is killed, which other numbers of
# ranks take to the end: the results of one process in one go, to the bit. Programs that failures.sh,
# programs.sh and same_files.sh do not cut.
. "$(dirname "$0")/../programs/checks.sh"
programs=$1
shift
mpirun=$*
. "$(dirname "$0")/runs.sh"

# cut NAME OPTIONS PROGRAM OPTION...: OPTIONS are those of checkpoints. A run that ends before it is
# killed has left its last checkpoint all the same.
cut() {
  name=$1 often=$2 program=$programs/$3
  shift 3
  "$program" "$@" --out "$work/$name" >/dev/null
  # shellcheck disable=SC2086
  begin 3 "$work/$name.h5" "$program" "$@" $often --checkpoint "$work/$name.h5" --out "$work/$name-cut"
  victim=$(last_rank)
  [ -z "$victim" ] || kill -KILL "$victim" 2>/dev/null || true
  end
  for ranks in 2; do
    # shellcheck disable=SC2086
    timeout 1200 $mpirun -n $ranks "$program" "$@" --restart "$work/$name.h5" --out "$work/$name-on" \
      >/dev/null
    for file in "$work/$name"/*; do
      file=$(basename "$file")
      case $file in checkpoint.h5 | index.html | *.png | *.vtkhdf | frames.bin) continue ;; esac # frames: from there on
      cmp "$work/$name/$file" "$work/$name-on/$file" || fail "$file of $name, gone on with $ranks ranks"
    done
    rm -r "$work/$name-on"
  done
}
cut dam "--every-checkpoint 0.02" mps-dam-break --cell 0.005715 --duration 0.1 --frames 0
cut water "--every-checkpoint 0.005" mps-dam-break --method mps --duration 0.02 --frames 0
cut footing "" mps-footing --cell 0.25 --soil 2x1 --settlement 0.05mm --rate 100mm/s --young 1e5kPa
cut tank "--every-checkpoint 0.02" mps-tank --case still --method classical --spacing 0.01 \
  --duration 0.06 --sample 0.01 --frames 0
if [ -x "$programs/mps-seawall" ]; then
  cut seawall "--every-checkpoint 0.005" mps-seawall --duration 0.02 --frames 0
fi
