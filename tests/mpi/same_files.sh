#!/bin/sh
# same_files.sh DIRECTORY MPIRUN...: programs on 3 ranks print and write what they do in one process,
# to the bit.
. "$(dirname "$0")/../programs/checks.sh"
programs=$1
shift
mpirun=$*

# same NAME PROGRAM OPTION...: all files, frames for ParaView among them.
same() {
  name=$1 program=$programs/$2
  shift 2
  "$program" "$@" --out "$work/$name-1" >"$work/$name.1"
  # shellcheck disable=SC2086
  timeout 1200 $mpirun -n 3 "$program" "$@" --out "$work/$name-3" >"$work/$name.3"
  sed "s:$name-1:$name-3:" "$work/$name.1" | cmp - "$work/$name.3" || fail "what $name prints"
  [ "$(ls "$work/$name-1")" = "$(ls "$work/$name-3")" ] || fail "files of $name: $(ls "$work/$name-3")"
  for file in "$work/$name-1"/*; do
    file=$(basename "$file")
    case $file in checkpoint.h5 | index.html | *.png) continue ;; esac
    cmp "$work/$name-1/$file" "$work/$name-3/$file" || fail "$file of $name"
  done
}

if [ "${STUDY:-no}" = yes ]; then # of 380 cases, dealt to the ranks
  same study mps-stability --study --method linear --duration 0.1
  exit 0
fi
same collapse mps-column-collapse --aspect 1 --width 0.02 --cell 0.005 --ppc 4
same dam mps-dam-break --cell 0.005715 --duration 0.1 --frames 4
same box mps-sliding-box --cell 0.02
same free_disc mps-rolling-disc --cell 0.02 --body disc --duration 0.1
same footing mps-footing --cell 0.25 --soil 2x1 --settlement 0.05mm --rate 100mm/s --young 1e5kPa
same cone mps-penetrometer --symmetry quarter --cell 0.05 --diameter 0.2 --soil 0.8x0.8x0.4 --depth 0.1 --rate 2 --ppc 1
# A hole, a surcharge and a state of the ground that a rank without particles does not know; implicit pressures.
same clay mps-penetrometer --symmetry quarter --law mcc --start 0.35 --depth 0.4 --soil 0.6x0.6x0.6 --cell 0.025 --surcharge 100kPa --rate 8 --ppc 1 \
  --permeability 1e-4
# Water in the pores: explicit pressures, and implicit ones.
same layer mps-consolidation --cell 0.125 --times 0.01
same mandel mps-consolidation --case mandel --cell 0.0625 --scheme implicit --times 0.002,0.01
# Layers of other laws and permeabilities, of which a rank may have none; water in a slope.
data=$(dirname "$0")/../programs/data
same layers mps-consolidation --layers "$data/consolidation_layers.csv" --times 0.002
same slope mps-slope --cell 1 --factor 1 --water-level 0 --drawdown 10
same backfill mps-wall --cell 0.1 --travel 1mm --rate 0.2 --layers "$data/wall_layers.csv" --water-table 0.4 --surcharge 2kPa
pile="--soil 0.6x0.6 --cell 0.04 --wall-thickness 0.08 --inner-diameter 0.32 --depth 0.06 --frames 2 --rate 0.5"
# shellcheck disable=SC2086
same pile mps-pile $pile --checkpoint "$work/pile.h5" --every-checkpoint 0.06
# The last checkpoint of the 3 ranks goes on with 2, and without mpirun, to the same results.
for start in "timeout 1200 $mpirun -n 2" ""; do
  # shellcheck disable=SC2086
  $start "$programs/mps-pile" $pile --restart "$work/pile.h5" --out "$work/on" >/dev/null
  for file in load.csv summary.json fields-1.csv fields-2.csv; do
    cmp "$work/pile-1/$file" "$work/on/$file" || fail "$file after a restart by '$start'"
  done
  rm -r "$work/on"
done
same limit mps-stability --spacing 3.2
# Water, of two blocks and more, which ranks share; its checkpoint goes on as the pile's does.
tank="--spacing 0.01 --duration 0.06 --sample 0.01 --frames 3 --gauge 0.4"
# shellcheck disable=SC2086
same tank mps-tank $tank --checkpoint "$work/tank.h5" --every-checkpoint 0.04
for start in "timeout 1200 $mpirun -n 2" ""; do
  # shellcheck disable=SC2086
  $start "$programs/mps-tank" $tank --restart "$work/tank.h5" --out "$work/on" >/dev/null
  for file in force.csv gauges.csv particles.csv summary.json; do
    cmp "$work/tank-1/$file" "$work/on/$file" || fail "$file after a restart by '$start'"
  done
  rm -r "$work/on"
done
same float mps-tank --case float --spacing 0.01 --duration 0.02 --frames 1
same plate mps-tank --case plate --duration 0.003 --frames 1
same water mps-dam-break --method mps --duration 0.02 --frames 2
same rock mps-flume --spacing 0.02 --length 5 --duration 0.03 --frames 1 --wall slope --rock 4.8,0,5,0.08,5.16,0.08,5,0 \
  --stone 2cm
# Water passes a crest, and returns.
same storm mps-flume --spacing 0.05 --waves jonswap --height 0.16 --wall caisson --freeboard 0.05 --length 2 --duration 7 \
  --frames 0
if [ -x "$programs/mps-seawall" ]; then
  same seawall mps-seawall --duration 0.02 --frames 0
  same coupled mps-seawall --coupled --duration 0.02 --frames 0
fi

# near NAME TABLE COLUMN PROGRAM OPTION...: with PETSc's solver of the pressure two ranks come to 1e-8 of the
# largest value that one process has in the column (its number) with the library's.
near() {
  name=$1 table=$2 column=$3 program=$programs/$4
  shift 4
  set -- "$@" --tolerance 1e-12
  "$program" "$@" --solver own --out "$work/$name-own" >/dev/null
  for solver in multigrid direct; do
    # shellcheck disable=SC2086
    timeout 1200 $mpirun -n 2 "$program" "$@" --solver $solver --out "$work/$name-$solver" >/dev/null
    paste -d, "$work/$name-own/$table" "$work/$name-$solver/$table" | awk -F, -v c="$column" '
      NR > 1 { n = NF / 2; d = $c - $(c + n); d = d < 0 ? -d : d; v = $c < 0 ? -$c : $c
               if (d > most) most = d; if (v > largest) largest = v }
      END { print most, "of", largest; exit !(NR > 1 && most < 1e-8 * largest) }' || fail "$name by $solver"
  done
}
near tank_petsc force.csv 3 mps-tank --spacing 0.01 --duration 0.06 --sample 0.01 --frames 0
near dam_petsc front.csv 3 mps-dam-break --method mps --duration 0.02 --frames 0
[ ! -x "$programs/mps-seawall" ] ||
  near seawall_petsc force.csv 2 mps-seawall --coupled --duration 0.01 --frames 0
"$programs/mps-dam-break" --solver direct --out "$work/no" 2>"$work/log" && fail "a solver of the grid"
has "$work/log" "--solver is for --method mps only"

# Implicit elasticity comes as close as its tolerance: the deflection of every particle to 1e-8.
if [ -x "$programs/mps-cantilever" ]; then
  "$programs/mps-cantilever" --height 2 --spacing 0.0606060606 --length 3.909090909 --out "$work/beam-1" >/dev/null
  # shellcheck disable=SC2086
  timeout 1200 $mpirun -n 2 "$programs/mps-cantilever" --height 2 --spacing 0.0606060606 --length 3.909090909 --out "$work/beam-2" >"$work/beam"
  has "$work/beam" "iterations of 2 ranks"
  [ "$(ls "$work/beam-1")" = "$(ls "$work/beam-2")" ] || fail "files of the beam"
  paste -d, "$work/beam-1/deflection.csv" "$work/beam-2/deflection.csv" | awk -F, '
    NR > 1 { d = $3 - $8; if (d < 0) d = -d; if (d > most) most = d; if ($3 < least) least = $3 }
    END { print "deflections apart by", most, "of", -least; exit !(NR > 60 && most < -1e-8 * least) }' ||
    fail "deflections of the beam"
fi
