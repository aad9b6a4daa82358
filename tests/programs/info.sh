#!/bin/sh
# info.sh DIRECTORY: mps-info shows what a run wrote, as text and as JSON, and refuses other and damaged files.
. "$(dirname "$0")/checks.sh"
run=$work/run
"$1/mps-column-collapse" --cell 0.02 --falls 0.3 --frames 3 --threads 1 --out "$run" >/dev/null 2>&1 ||
  fail "mps-column-collapse"

"$1/mps-info" "$run/checkpoint.h5" "$run/column.vtkhdf" >"$work/text" || fail "mps-info"
tr -s '[:space:]' ' ' <"$work/text" >"$work/flat"
for text in "checkpoint of mps-column-collapse, written by libmps" "solver WLS-MPM" "particles 450" \
  "dimensions 2" "to go on mps-column-collapse --restart" "h 0.02" "falls 0.3" "spline 3" \
  "velocity 2 x float64, m/s" "series of frames for ParaView" "first 0 s" "frames 3" "stress 4 x float64, Pa"; do
  has "$work/flat" "$text"
done

"$1/mps-info" --json "$run/checkpoint.h5" "$run/column.vtkhdf" >"$work/json" || fail "mps-info --json"
if command -v python3 >/dev/null; then
  python3 - "$work/json" "$run/summary.json" <<'EOF' || fail "the JSON of mps-info"
import json, sys
checkpoint, series = json.load(open(sys.argv[1]))
assert checkpoint["kind"] == "checkpoint" and series["kind"] == "series", (checkpoint["kind"], series["kind"])
assert checkpoint["particles"] == series["particles_least"] == series["particles_most"] == 450
assert abs(checkpoint["time_s"] - series["time_last_s"]) < 1e-12
assert checkpoint["version"] == series["version"] == json.load(open(sys.argv[2]))["version"]
assert checkpoint["options"]["ppc"] == 9 and checkpoint["options"]["h"] == 0.02
assert series["fields"]["density"] == checkpoint["fields"]["density"] == "1 x float64, kg/m3"
EOF
fi

# A file that is damaged, cut short or of another kind: one line, exit code 1, and the others are shown.
head -c 20000 "$run/checkpoint.h5" >"$work/cut.h5"
cp "$run/checkpoint.h5" "$work/flipped.h5"
printf 'x' | dd of="$work/flipped.h5" bs=1 seek=30000 conv=notrunc 2>/dev/null
head -c 3000 "$run/column.vtkhdf" >"$work/cut.vtkhdf"
: >"$work/empty"
for file in cut.h5 flipped.h5 cut.vtkhdf empty run run/summary.json run/column.xdmf none; do
  code=0
  "$1/mps-info" "$work/$file" "$run/checkpoint.h5" >"$work/text" 2>"$work/error" || code=$?
  [ $code -eq 1 ] || fail "exit code $code for $file"
  [ "$(wc -l <"$work/error")" -eq 1 ] || fail "one line for $file"
  has "$work/error" "mps-info: $work/$file: "
  has "$work/text" "WLS-MPM"
done
for arguments in "" "--jsn $run/checkpoint.h5"; do
  code=0
  "$1/mps-info" $arguments 2>/dev/null || code=$?
  [ $code -eq 2 ] || fail "exit code $code for '$arguments'"
done
