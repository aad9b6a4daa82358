#!/bin/sh
# shared.sh DIRECTORY: programs that share a machine: SIGTERM and SIGHUP end a run as Ctrl-C does, a second program
# is kept out of the directory of results, temporary names lead to no other file, and a model file takes time in
# proportion to its size.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
programs=$1
tank="$programs/mps-tank"
dam="$programs/mps-dam-break --threads 1 --frames 0"

# begin NAME [COMMAND...]: a long run in $work/NAME, until it has begun.
begin() {
  name=$1
  shift
  rm -rf "$work/$name"
  "$@" "$tank" --duration 100 --threads 1 --frames 0 --out "$work/$name" >"$work/out" 2>"$work/log" &
  pid=$!
  until [ -s "$work/out" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.05; done
  used 0.5
}
ends() { # SIGNAL: the run ends with its results
  kill "-$1" "$pid"
  status=0
  wait "$pid" || status=$?
  [ "$status" -eq 130 ] || fail "SIG$1: exit code $status: $(cat "$work/log")"
  [ "$(wc -l <"$work/log")" -eq 1 ] || fail "SIG$1: more than one line: $(cat "$work/log")"
  has "$work/log" "mps-tank: interrupted"
  has "$work/$name/summary.json" '"outcome": "interrupted"'
  for file in force.csv gauges.csv particles.csv; do [ -s "$work/$name/$file" ] || fail "SIG$1: no $file"; done
  [ -z "$(find "$work/$name" -name '*.part')" ] || fail "temporary files are left"
}
begin term
ends TERM
begin hup
ends HUP
# After nohup a terminal that hangs up stops nothing.
begin nohup nohup
kill -HUP "$pid"
sleep 0.5
kill -0 "$pid" 2>/dev/null || fail "nohup: $(cat "$work/log")"

# A second program in the same directory, by whatever name, is refused and changes nothing; the first goes on.
ln -s nohup "$work/alias"
for directory in nohup alias ./nohup/../nohup; do
  status=0
  $dam --duration 0.02 --out "$work/$directory" >"$work/out2" 2>"$work/log2" || status=$?
  [ "$status" -eq 1 ] || fail "a second program: exit code $status"
  has "$work/log2" "mps-dam-break: another program is writing into the directory"
  [ "$(wc -l <"$work/log2")" -eq 1 ] || fail "more than one line: $(cat "$work/log2")"
done
[ ! -e "$work/nohup/front.csv" ] || fail "the second program has written"
# The lock ends with the process, also when that is killed.
kill -KILL "$pid"
wait "$pid" 2>/dev/null || true
$dam --width 0.05 --cell 0.01 --duration 0.02 --out "$work/nohup" >"$work/out2" 2>"$work/log2" || fail "after the first was killed: $(cat "$work/log2")"
[ -s "$work/nohup/front.csv" ] || fail "no front.csv"

# What a killed program has left is replaced; a link in its place is not followed, and is an error.
rm -r "$work/nohup"
mkdir "$work/nohup"
echo "kept" >"$work/mine"
echo "left" >"$work/nohup/front.csv.part"
$dam --width 0.05 --cell 0.01 --duration 0.02 --out "$work/nohup" >/dev/null 2>"$work/log2" || fail "a file that was left: $(cat "$work/log2")"
[ ! -e "$work/nohup/front.csv.part" ] || fail "front.csv.part is left"
for name in front.csv front.png; do
  [ $name = front.csv ] || command -v gnuplot >/dev/null || continue
  ln -s "$work/mine" "$work/nohup/$name.part"
  status=0
  $dam --width 0.05 --cell 0.01 --duration 0.02 --out "$work/nohup" >/dev/null 2>"$work/log2" || status=$?
  [ "$status" -eq 1 ] || fail "a link: exit code $status"
  has "$work/log2" "$name.part: something that is no file has this name"
  has "$work/mine" "kept"
  rm "$work/nohup/$name.part"
done

# Model files: 50 kB of brackets, 100 000 keys, as many anchors and directives, in some seconds of the processor.
model() { # TEXT: the error of $work/model.yaml
  status=0
  (ulimit -t 5 && "$programs/mps-flume" --model "$work/model.yaml" --out "$work/model") >"$work/out" 2>"$work/log" || status=$?
  if grep -q "built without libyaml" "$work/log"; then exit 0; fi
  [ "$status" -eq 2 ] || fail "model: exit code $status for $1: $(head -c 300 "$work/log")"
  has "$work/log" "$1"
}
awk 'BEGIN { for (k = 0; k < 50000; k++) printf "[" }' >"$work/model.yaml"
model "line 1: more than 10 levels"
awk 'BEGIN { for (k = 0; k < 50000; k++) printf "{a: " }' >"$work/model.yaml"
model "line 1: more than 10 levels"
awk 'BEGIN { for (k = 0; k < 1000; k++) printf "- " }' >"$work/model.yaml"
model "line 1: more than 10 levels"
awk 'BEGIN { for (k = 0; k < 100000; k++) printf "k%d: 1\n", k }' >"$work/model.yaml"
model "line 1: unknown key k0"
awk 'BEGIN { for (k = 0; k < 100000; k++) printf "k%d: 1\n", k % 99000 }' >"$work/model.yaml"
model "line 99001: k0 is given twice"
awk 'BEGIN { for (k = 0; k < 80000; k++) printf "- &a%d 1\n", k }' >"$work/model.yaml"
model "line 1: an anchor"
awk 'BEGIN { for (k = 0; k < 60000; k++) printf "%%TAG !a%d! b\n", k; print "--- 1" }' >"$work/model.yaml"
model "line 1: a tag directive"
awk 'BEGIN { printf "gauge: ["; for (k = 0; k < 300000; k++) printf "1,"; print "1]" }' >"$work/model.yaml"
model "line 1: --gauge must be at most 16 lengths"
