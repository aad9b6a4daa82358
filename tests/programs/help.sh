#!/bin/sh
# help.sh DIRECTORY: --help of every example tells units, ranges and defaults.
. "$(dirname "$0")/checks.sh"
for program in mps-wave mps-stability; do
  "$1/$program" --help >"$work/help" || fail "$program --help"
  tr -s '[:space:]' ' ' <"$work/help" >"$work/flat"
  for text in "Usage: $program" "--spacing [m]" "default 1 Hz)" "[m/s]" "--wave S|P" \
    "(default verlet)" "--out DIR" "--threads N"; do
    has "$work/flat" "$text"
  done
  [ "$(awk 'length > 100' "$work/help" | wc -l)" -eq 0 ] || fail "$program --help has long lines"
  "$1/$program" --version >"$work/version"
  has "$work/version" "libmps"
done
has "$work/help" "--study"
for program in mps-sliding-box mps-rolling-disc mps-footing mps-pile; do
  "$1/$program" --help >"$work/help" || fail "$program --help"
  for text in "Usage: $program" "--cell [m]" "[N/m]" "(default" "--out DIR" "--threads N"; do
    has "$work/help" "$text"
  done
  [ "$(awk 'length > 100' "$work/help" | wc -l)" -eq 0 ] || fail "$program --help has long lines"
done
for program in mps-dam-break mps-column-collapse; do
  "$1/$program" --help >"$work/help" || fail "$program --help"
  for text in "Usage: $program" "--cell [m]" "(default" "--out DIR" "--threads N"; do
    has "$work/help" "$text"
  done
  [ "$(awk 'length > 100' "$work/help" | wc -l)" -eq 0 ] || fail "$program --help has long lines"
done
"$1/mps-element" --help >"$work/help" || fail "mps-element --help"
for text in "Usage: mps-element" "--path iso|oedometer|cu" "(default" "--out DIR" "--threads N"; do
  has "$work/help" "$text"
done
# An option with its choices is one word, which completions read: it is not broken.
[ "$(awk 'length > 100 && NF > 2' "$work/help" | wc -l)" -eq 0 ] || fail "mps-element: long lines"
"$1/mps-penetrometer" --help >"$work/help" || fail "mps-penetrometer --help"
for text in "Usage: mps-penetrometer" "--tip cone|sphere|stl" "--cell [m]" "(default" "--out DIR"; do
  has "$work/help" "$text"
done
[ "$(awk 'length > 100' "$work/help" | wc -l)" -eq 0 ] || fail "mps-penetrometer: long lines"
# The same weights as the library, wherever they can be chosen.
for program in mps-sliding-box mps-rolling-disc mps-footing mps-pile mps-dam-break \
  mps-column-collapse mps-penetrometer mps-slope mps-site-response mps-wall; do
  "$1/$program" --help >"$work/help"
  has "$work/help" "degree of the weights (default 3)"
done
for program in mps-tank mps-flume mps-seawall mps-dam-break mps-wave mps-pile mps-footing mps-consolidation mps-penetrometer \
  mps-slope mps-site-response mps-wall \
  mps-column-collapse mps-sliding-box mps-rolling-disc; do
  [ -x "$1/$program" ] || continue
  "$1/$program" --help >"$work/help" || fail "$program --help"
  for text in "--checkpoint FILE" "--restart FILE" "--every-checkpoint [s]" "--frames N"; do
    has "$work/help" "$text"
  done
  [ "$(awk 'length > 100' "$work/help" | wc -l)" -eq 0 ] || fail "$program --help has long lines"
done
