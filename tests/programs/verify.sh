#!/bin/sh
# verify.sh PROGRAMS VERIFY: scripts/verify runs a case, stores what a program printed, renders the page from that
# without running anything, and finds a table, a stored number and a program that are wrong.
set -eu
programs=$1
verify=$2
here=$(mktemp -d)
trap 'rm -rf "$here"' EXIT
mkdir -p "$here/docs/cases" "$here/build/programs"
ln -s "$programs"/mps-* "$here/build/programs/"
cat >"$here/docs/cases/page.ini" <<'END'
[slips]
group = discs
title = Disc slips
quantity = path
command = mps-rolling-disc --fill rings --duration 0.05 --cell {r}
read = x_error_05
scale = 100
error = percent
bar = 1
values = 0.02 0.01
cells = 2.5 5
[relative]
group = discs
title = Angle
command = mps-rolling-disc --fill rings --duration 0.05 --cell 0.02
read = cell
reference = 0.01
bar = 50
END
cat >"$here/docs/page.md" <<'END'
Text before.
<!-- results of page: discs -->
<!-- end of results -->
Text after.
END
call() { "$verify" --docs "$here/docs" --build "$here/build" --out "$here/out" "$@" >"$here/said" 2>&1; }
fails() { if call "$@"; then echo "$* should have failed"; cat "$here/said"; exit 1; fi; }

call --case slips
printed=$(sed -n 's/.*"x_error_05": \([^,]*\).*/\1/p' "$here"/out/*0.02/summary.json)
stored=$(sed -n '/"0.02"/,/}/s/.*"number": \([^,]*\).*/\1/p' "$here/docs/results/page/slips.json")
awk -v a="$printed" -v b="$stored" 'BEGIN { exit !(b != 0 && (100 * a - b) ^ 2 < (1e-8 * b) ^ 2) }' ||
  { echo "stored $stored of $printed"; exit 1; }
grep -q '^| Disc slips | path |.* 0.02: .* %; 0.01: .* %' "$here/docs/page.md"
grep -q '^Text after' "$here/docs/page.md"
call --check

# The order is that of the two errors.
errors=$(sed -n 's/.*"number": \([^,]*\).*/\1/p' "$here/docs/results/page/slips.json" | tr '\n' ' ')
order=$(awk -F' [|] ' '/Disc slips/ { print $5 }' "$here/docs/page.md")
echo "errors $errors order $order"
echo "$errors $order" | awk '{ p = $1 * $2 > 0 ? log($1 / $2) / log(2) : 0; exit !(p == 0 ? $3 == "" : ($3 - p) ^ 2 < 0.0026) }'
cp "$here/docs/page.md" "$here/whole"

# A run is not needed for the tables, and an error above its bar is a failure of the run.
echo "Text before.
<!-- results of page: discs -->
<!-- end of results -->
Text after." >"$here/docs/page.md"
fails --check
call --render
cmp "$here/docs/page.md" "$here/whole"
fails --case relative # 0.02 is 100 % above 0.01
grep -q 'missed' "$here/docs/page.md"
call --check

# The bar is for the last value, which is the finest; with `judged = all` for each, wherever it stands.
sed -i '/^reference = 0.01$/a values = 0.02 0.01' "$here/docs/cases/page.ini"
sed -i 's/--cell 0.02$/--cell {r}/' "$here/docs/cases/page.ini"
call --case relative
if grep -q 'missed' "$here/docs/page.md"; then echo "0.01 is no error"; exit 1; fi
sed -i 's/^values = 0.02 0.01$/&\njudged = all/' "$here/docs/cases/page.ini"
fails --case relative
grep -q '50 %, missed' "$here/docs/page.md"
sed -i '/^judged/d' "$here/docs/cases/page.ini"
call --render

# A table written by hand, a command that has changed since, a case that is gone, a program that fails.
sed -i 's/Disc slips | path/Disc slips | way/' "$here/docs/page.md"
fails --check
call --render
sed -i 's/--duration 0.05 --cell {r}/--duration 0.04 --cell {r}/' "$here/docs/cases/page.ini"
fails --check
grep -q 'another command' "$here/said"
fails --case nothing
sed -i 's/--duration 0.04/--duration 9/' "$here/docs/cases/page.ini"
fails --case slips
grep -q 'FAILED' "$here/said"
sed -i 's/error = percent/error = per cent/' "$here/docs/cases/page.ini"
fails --list
grep -q 'error is per cent, must be one of' "$here/said"
sed -i 's/error = per cent/error = percent/; s/--duration 9/--duration 0.05/' "$here/docs/cases/page.ini"

# Claims of a paper: one row of all its cases, a number of a table of the results, a command that must fail; a claim
# without a row is named, and so is a case with neither a number nor a reason.
cat >"$here/docs/cases/claims.ini" <<'END'
[claims]
all = A1-A3
[path]
group = paper
claim = A1
title = Disc slips
printed = good
method = paper
quantity = path
command = mps-rolling-disc --paper --friction 0 --duration 0.05 --cell 0.02
read = motion.csv /^0.05,([^,]*),/
unit = m
error = none
[path-default]
group = paper
claim = A1
title = Disc slips
quantity = path
command = mps-rolling-disc --duration 0.05 --cell 0.02
read = x
unit = m
reference = 0.00613125
says = Holds.
[refused]
group = paper
claim = A2
title = Refused
command = mps-rolling-disc --cell 1
code = 2
read = /--cell is (\\S+) m/
error = none
END
sed -i 's/\\\\S/\\S/' "$here/docs/cases/claims.ini"
printf '<!-- results of claims: paper -->\n<!-- end of results -->\n' >"$here/docs/claims.md"
call --page claims
grep -q '^| A1 | Disc slips | `mps-rolling-disc --paper .*<br>`mps-rolling-disc --duration .* | good | path: 0.00[0-9]* m | path: 0.00[0-9]* m (.* %) | Holds. |' \
  "$here/docs/claims.md" || { echo "no row of the claim"; cat "$here/docs/claims.md"; exit 1; }
grep -q '^| A2 | Refused |.*| 1 |' "$here/docs/claims.md"
fails --check
grep -q 'claims: claim A3 has no row' "$here/said"
printf '[later]\ngroup = paper\nclaim = A3\ntitle = Later\ncommand = mps-rolling-disc\nread = x\nerror = none\n' >>"$here/docs/cases/claims.ini"
call --render
fails --check
grep -q 'claims, later: neither a number of - nor a reason' "$here/said"
sed -i 's/^command = mps-rolling-disc$/reason = not run by this version: long/' "$here/docs/cases/claims.ini"
call --case path-default --case slips
call --check || { cat "$here/said"; exit 1; }
