#!/bin/sh
# flume_model.sh DIRECTORY MODELS: mps-flume with model files: those that are installed, still water on a
# caisson on rock against hydrostatics, waves on it, a restart, and errors with file, line, key and value.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
flume="$1/mps-flume"
run="--threads 1 --frames 0"

# The seawall: rest force rho g .35^2/2 by its shapes, tables of probes and faces, pictures, animation.
"$flume" --model "$2/breakwater.yaml" $run --duration 0.2 --animation 3 --out "$work/wall" >"$work/log" 2>&1
in_range "$work/wall/summary.json" force_still 600.86 600.87
has "$work/wall/probes.csv" "at_5.02_0.06_m_Pa,at_5.5_0.3_m_Pa,at_6.12_0.53_m_Pa"
has "$work/wall/faces.csv" "x_m,y_m,pressure_Pa,above_rest_Pa"
picture "$work/wall/water.png" 1085x0
picture "$work/wall/pressures.png" 700x620
! command -v gnuplot >/dev/null || [ -s "$work/wall/animation.gif" ] || fail "no animation"

# Still water: no force on the caisson, uplift rho g .3 .3 below it.
caisson="--model $2/caisson.yaml --length 5 --spacing 0.025"
"$flume" $caisson $run --absorb none --height 1e-5 --animation 0 --duration 1.5 --out "$work/still" >"$work/log" 2>&1
is "$work/still/force.csv" uplift_N -1 882.9 25
is "$work/still/force.csv" force_N -1 0 25
in_range "$work/still/summary.json" force_still 0 0

# Waves: the crest loads it, the uplift is that of the rock beside the triangle.
waves="$caisson $run --animation 0 --height 0.08 --window 4,7"
"$flume" $waves --duration 7 --every-checkpoint 4 --out "$work/waves" >"$work/log" 2>&1
s=$work/waves/summary.json
in_range "$s" force_peak 100 600
in_range "$s" uplift_peak 20 250
in_range "$s" uplift_triangle 20 250
in_range "$s" uplift_goda 20 250
in_range "$s" safety_sliding 0.5 20
in_range "$s" safety_sliding_bedding 0.5 20
in_range "$s" safety_overturning_bedding 0.5 50
picture "$work/waves/pressures.png" 1200x620

# On from a checkpoint, and not with other shapes.
if [ -f "$work/waves/checkpoint.h5" ]; then
  "$flume" $waves --duration 7 --restart "$work/waves/checkpoint.h5" --out "$work/again" >"$work/log" 2>&1
  for file in gauges.csv force.csv probes.csv faces.csv summary.json; do
    cmp "$work/waves/$file" "$work/again/$file" || fail "another $file after a restart"
  done
  cp "$2/caisson.yaml" "$work/here.yaml"
  short="--model $work/here.yaml --length 5 --spacing 0.025 $run --animation 0"
  "$flume" $short --duration 0.3 --every-checkpoint 0.1 --out "$work/short" >"$work/log" 2>&1
  sed 's/\[4.4, 0.1\]/[4.5, 0.1]/' "$2/caisson.yaml" >"$work/here.yaml"
  ! "$flume" $short --duration 0.3 --restart "$work/short/checkpoint.h5" --out "$work/g" 2>"$work/log" ||
    fail "a restart with other rock"
  has "$work/log" "rock0/corner2/x is 4.4"
  sed 's/\[4.06, 0.1\]/[4.07, 0.1]/' "$2/caisson.yaml" >"$work/here.yaml"
  ! "$flume" $short --duration 0.3 --restart "$work/short/checkpoint.h5" --out "$work/g" 2>"$work/log" ||
    fail "a restart with another probe"
  has "$work/log" "other probes than those of $work/here.yaml"
fi

# A wall on a bed that has risen to .1 m: rho g .3^2/2, moment .1 m of it about its foot. No rock below a caisson.
printf 'spacing: 0.05\nbed: [[0,0],[2,0],[4,0.1]]\nlength: 6\nwall: vertical\nheight: 1e-5\n' >"$work/risen.yaml"
"$flume" --model "$work/risen.yaml" $run --duration 0.1 --sample 0.1 --out "$work/risen" >"$work/log" 2>&1
in_range "$work/risen/summary.json" force_still 441.44 441.46
is "$work/risen/force.csv" force_N -1 441.45 5
is "$work/risen/force.csv" moment_N_m -1 44.1 1.5
printf 'length: 6\nspacing: 0.05\nend: closed\ncaisson: [[3,0.2],[3,0.6],[3.4,0.6],[3.4,0.2]]\n' >"$work/held.yaml"
"$flume" --model "$work/held.yaml" $run --duration 0.1 --sample 0.1 --out "$work/held" >"$work/log" 2>&1
has "$work/log" "no rock below the caisson: it is held where it is, and has no safeties"
has "$work/held/summary.json" '"safety_sliding": null'

# Waves over a bed that rises to half the depth: gauges there are none of the incident waves, the far piston absorbs by
# the depth before it (with that at the maker it reflects .2), and the height follows from the flow of energy (1.054 by
# linear theory; .97 to 1.06 with a second harmonic of a quarter). On a beach there is no far piston.
for l0 in 0.06 0.05 0.04; do
  printf 'depth: 0.6\nheight: 0.06\nperiod: 1.6\nbed: [[0,0],[3,0],[4.5,0.3]]\nlength: 9\n' >"$work/shoal.yaml"
  printf 'gauge: [1,1.3,1.8,2.6,4,5.5,5.8,6.3,7.1]\nwindow: [11,16]\nduration: 16\n' >>"$work/shoal.yaml"
  "$flume" --model "$work/shoal.yaml" $run --spacing $l0 --out "$work/shoal" >"$work/log" 2>&1
  has "$work/log" "the gauge at 4 m lies between the ends of structure, rock, a bed that is not level, or zone"
  in_range "$work/shoal/summary.json" H_incident 0.057 0.062
  in_range "$work/shoal/summary.json" reflection 0 0.05
  in_range "$work/shoal/summary.json" reflection_behind 0 0.06
  in_range "$work/shoal/summary.json" transmission 0.97 1.06
done
printf 'spacing: 0.05\nbed: [[0,0],[3,0],[5,0.5]]\nlength: 6\nheight: 0.03\n' >"$work/beach.yaml"
"$flume" --model "$work/beach.yaml" $run --duration 2 --out "$work/beach" >"$work/log" 2>&1
has "$work/log" "the bed is 0.5 m high at the far end, with less than 2 spacings of water above it: no piston absorbs there"
is "$work/beach/force.csv" end_m -1 0 0

# Rock by options: the file's and these agree in the water at rest.
"$flume" $run --wall slope --spacing 0.04 --length 2 --duration 0.1 --rock 1.8,0,2,0.08,2.16,0.08,2,0 --stone 2cm \
  --out "$work/rock" >"$work/log" 2>&1
in_range "$work/rock/summary.json" particles 490 620
! grep -q "particles across" "$work/log" || fail "a warning of rock that does not reach the surface"
thin() { # RIGHT: rock from 2 m to there
  printf 'length: 4\nspacing: 0.05\nrock: [{corners: [[2,0],[2,0.6],[%s,0.6],[%s,0]], porosity: 0.49, stone: 2cm}]\n' $1 $1 \
    >"$work/thin.yaml"
  "$flume" --model "$work/thin.yaml" $run --duration 0.1 --sample 0.1 --out "$work/thin" >"$work/log" 2>&1
}
thin 2.2
has "$work/log" "the rock from 2 to 2.2 m is 2.8 particles across"
thin 2.4
! grep -q "particles across" "$work/log" || fail "a warning of rock of 5.6 particles"

# Errors: file, line, key, value, what is allowed.
refuse() { # TEXT MODEL
  printf "$2" >"$work/bad.yaml"
  code=0
  "$flume" --model "$work/bad.yaml" --out "$work/refused" 2>"$work/log" >&2 || code=$?
  [ $code -eq 2 ] || fail "exit code $code for $2"
  has "$work/log" "$1"
}
refuse "bad.yaml, line 2: height is -1 m, must be in" 'depth: 0.4\nheight: -1\n'
refuse "bad.yaml, line 1: unknown key hight: did you mean height?" 'hight: 0.1\n'
refuse "bad.yaml, line 2: --porosity is not used: it needs --rock" 'waves: regular\nporosity: 0.4\n'
refuse "bad.yaml, line 2: --gauge must be at most 16 lengths" 'depth: 0.4\ngauge: [1, x]\n'
refuse "bad.yaml, line 1: --depth must be at least 5 times --spacing" 'depth: 0.2\nspacing: 0.05\n'
refuse "bad.yaml, line 1: unknown key shape" 'shape: 0.1\n'
refuse "bad.yaml, line 1: waves is foo, must be one of regular|" 'waves: foo\n'
refuse "bad.yaml, line 1: period is 5m: a time is wanted" 'period: 5m\n'
refuse "bad.yaml, line 2: bed: Y is x, must be a length in m" 'depth: 0.4\nbed: [[0, 0], [1, x]]\n'
refuse "bad.yaml, line 3: bed: X is nan, must be" 'bed:\n- [0, 0]\n- [nan, 0]\n'
refuse "bad.yaml, line 2: depth is given twice" 'depth: 0.4\ndepth: 3\n'
refuse "line 1: rock: porosity is 2, must be a number in [0.1, 1]" 'rock: [{corners: [[1,0],[2,0],[2,1]], porosity: 2}]\n'
refuse "line 1: rock: unknown key poro" 'rock: [{corners: [[1,0],[2,0],[2,1]], poro: 0.2}]\n'
refuse "line 1: rock 1,0 needs the size of its stones" 'rock: [{corners: [[1,0],[2,0],[2,1]]}]\n'
refuse "corners must be a list of 3 to 64 points" 'rock: [{corners: [[1,0],[2,0]]}]\n'
refuse "bad.yaml, line 2: did not find expected" '[1,2\n'
refuse "out is an option of the command line alone" 'out: x\n'
refuse "bad.yaml, line 2: an alias" 'a: &b 3\nc: *b\n'
refuse "bad.yaml is empty" ''
refuse "a model is a map" 'x\n'
refuse "gauge must be a value or a list of values" 'gauge: [1, [2]]\n'
refuse "line 3: structure 5.2,0.2 must be at least 2 times --spacing above --depth" \
  'structure: [[4, 0],\n [5, 0.2],\n [5.2, 0.2]]\n'
refuse "line 2: structure 4,0 must be the last corner of the bed" \
  'bed: [[0, 0], [3, 0]]\nstructure: [[4, 0], [5, 0.6], [5.2, 0.6]]\n'
refuse "structure 3,0.6 lies before the toe" 'structure: [[4, 0], [5, 0.6], [3, 0.6]]\n'
refuse "--wall must be none" 'structure: [[4, 0], [5, 0.6], [5.2, 0.6]]\nwall: slope\n'
refuse "caisson 4,0 must be 3.7 times --spacing above the bed" \
  'caisson: [[4, 0], [4, 0.6], [4.3, 0.6], [4.3, 0]]\nlength: 8\n'
refuse "probe 4,0.2 is more than half a --spacing from all faces" 'probe: [[4, 0.2]]\nlength: 8\n'
refuse "line 3: caisson 3,0.2 must be 3.7 times --spacing above the bed, and as far from a structure" \
  'spacing: 0.05\nlength: 6\ncaisson: [[3,0.2],[3,0.6],[3.4,0.6],[3.4,0.2]]\nend: closed\nstructure: [[3,0],[3.2,0.3],[3.4,0]]\n'
refuse "line 3: caisson 3,0.1 must be 3.7 times" \
  'spacing: 0.05\nlength: 6\ncaisson: [[3,0.1],[3,0.6],[3.4,0.6],[3.4,0.1]]\nend: closed\n'
refuse "line 1: --wall-density is too low: the caisson floats, its weight in still water would be -294.3 N" \
  'wall-density: 500\nwall: caisson\nspacing: 0.05\n'
refuse "line 1: rock 9,0 lies outside the flume" 'rock: [{corners: [[9,0],[9.5,0],[9,0.4]], stone: 3cm}]\nlength: 8\n'
refuse "line 1: rock 1,-1 lies outside the flume" 'rock: [{corners: [[1,-1],[2,-1],[2,0],[1,0]], stone: 3cm}]\n'
refuse "line 1: rock 1,0 has sides that cross" 'rock: [{corners: [[1,0],[2,0],[1,1],[2,1]], stone: 3cm}]\n'
refuse "line 1: bed 4,0.1 must be at height 0, where the structures of --wall stand" \
  'bed: [[0,0],[2,0],[4,0.1]]\nlength: 6\nwall: slope\n'
refuse "line 1: bed 4,0.1 is the end of a slope at the far end" 'bed: [[0,0],[2,0],[4,0.1]]\nlength: 4\nwall: vertical\n'
refuse "line 1: --length is less than that of the bed" 'length: 3\nbed: [[0,0],[2,0],[4,0]]\nwall: slope\n'
refuse "line 2: --zone is longer than --length" 'absorb: zone\nzone: 4\nlength: 6\n'
refuse "line 2: --focus must be in the flume" 'waves: focused\nfocus: [7, 20]\nlength: 6\n'
refuse "--waves file needs --period" 'waves: file\nlevels: x.csv\n'
refuse "--length is that to the toe" 'structure: [[4, 0], [5, 0.6], [6, 0.6]]\nlength: 8\n'

code=0
"$flume" --profile 0,0,0.8,0.4,1,0.4 --out "$work/refused" 2>"$work/log" >&2 || code=$?
[ $code -eq 2 ] || fail "exit code $code for a profile without --wall profile"
has "$work/log" "--profile needs --wall profile"

# Cut off anywhere: an error or a smaller model, no crash.
bytes=$(wc -c <"$2/caisson.yaml")
n=400
while [ $n -lt "$bytes" ]; do
  head -c $n "$2/caisson.yaml" >"$work/cut.yaml"
  code=0
  "$flume" --model "$work/cut.yaml" $run --spacing 0.08 --length 8 --duration 20ms --sample 20ms --out "$work/cut" \
    >"$work/log" 2>&1 || code=$?
  [ $code -le 2 ] || fail "exit code $code, cut after $n bytes: $(cat "$work/log")"
  n=$((n + 37))
done
