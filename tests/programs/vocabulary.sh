#!/bin/sh
# vocabulary.sh SOURCES DIRECTORY: every option that the programs' sources speak of is in the one table of options, and
# every option of the table belongs to a program.
. "$(dirname "$0")/checks.sh"
tr '\n' ' ' <"$1/common/vocabulary.c" | grep -oE ' (NUMBER|INTEGER|CHOICE|TEXT|FLAG)\( *"[A-Za-z0-9-]+"' |
  sed 's/.*( *"//; s/"//' >"$work/table"
[ "$(wc -l <"$work/table")" -gt 200 ] || fail "the table is not found"
sort -uf "$work/table" | cmp -s - "$work/table" || fail "the table is not in the order of the alphabet"
# One of mps-info, whose command line is its own.
printf '%s\n' help version json | LC_ALL=C sort - "$work/table" >"$work/known"

# In texts, "--name", and in lists that are looked up, options_given(table, "name").
find "$1" -name '*.[ch]' ! -name 'vocabulary.*' ! -path '*/common/options.[ch]' -exec cat {} + >"$work/sources"
sed 's/\\n/ /g' "$work/sources" | grep -oE '"([^"\\]|\\.)*"' | grep -oE '(^|[^a-zA-Z0-9-])--[a-zA-Z][a-zA-Z0-9-]*' |
  sed 's/.*--//' | LC_ALL=C sort -u | LC_ALL=C comm -23 - "$work/known" >"$work/unknown"
grep -oE 'options_given\([a-z>()-]+, "[^"]*"' "$work/sources" | sed 's/.*"\(.*\)"/\1/' | LC_ALL=C sort -u |
  LC_ALL=C comm -23 - "$work/known" >>"$work/unknown"
[ ! -s "$work/unknown" ] || fail "not in common/vocabulary.c: $(tr '\n' ' ' <"$work/unknown")"

tr '\n' ' ' <"$work/sources" | grep -oE 'OPTION_[A-Z_]+\( *"[^"]*"' | sed 's/.*"\(.*\)"/\1/' >"$work/used"
printf 'out\nthreads\n' | LC_ALL=C sort -u - "$work/used" >"$work/own"
LC_ALL=C sort "$work/table" | LC_ALL=C comm -23 - "$work/own" >"$work/idle"
[ ! -s "$work/idle" ] || fail "of no program: $(tr '\n' ' ' <"$work/idle")"

# One name of resolution: --cell in a grid, --spacing of particles alone.
for program in "$2"/mps-*; do
  [ -f "$program" ] && [ -x "$program" ] || continue
  "$program" --help >"$work/help"
  if grep -q "^  --\(h\|cells\|nx\|ny\|dx\|size\|resolution\) " "$work/help"; then fail "$program: another word for resolution"; fi
  case $program in */mps-dam-break) continue ;; esac
  if grep -q "^  --cell " "$work/help" && grep -q "^  --spacing " "$work/help"; then fail "$program: two words for resolution"; fi
  if grep -q "^  --cell " "$work/help"; then has "$work/help" "  --courant [1]"; fi
done

# Lengths that must divide are rounded, and that is said, on stderr and in the summary.
"$2/mps-consolidation" --cell 0.3 --times 1e-4 --threads 1 --out "$work/rounded" >/dev/null 2>"$work/said"
has "$work/said" "--cell is 0.3 m, taken as 0.333333 m: 3 in the model's 1 m"
grep '"warnings"' "$work/rounded/summary.json" | grep -q -- "--cell is 0.3 m" || fail "summary.json does not say it"
