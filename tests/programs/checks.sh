# checks.sh - what the test scripts share: sourced, not run. Sets `work` to an empty directory.
# SPDX-License-Identifier: BSD-3-Clause
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

fail() {
  echo "FAILED: $*"
  exit 1
}

# in_range FILE KEY LOW HIGH: the number of a key in a summary.json lies between the bounds.
in_range() {
  value=$(sed -n "s/^ *\"$2\": \([^,]*\),*$/\1/p" "$1")
  echo "$2 = $value"
  awk -v x="$value" -v lo="$3" -v hi="$4" \
    'BEGIN { exit !(x ~ /^[-+0-9.eE]+$/ && x + 0 >= lo && x + 0 <= hi) }' ||
    fail "$2 is '$value', expected $3 to $4"
}

# has FILE TEXT
has() { grep -qF -- "$2" "$1" || fail "no \"$2\" in $1: $(cat "$1")"; }

# picture FILE WIDTHxHEIGHT COLOUR...: the picture was drawn whole, in that size, with lines or points
# of these colours; see check-png. Nothing is looked at without gnuplot, and without python3 only the
# name.
here=$(dirname "$0")
picture() {
  command -v gnuplot >/dev/null || return 0
  [ -s "$1" ] || fail "no picture $1"
  python3 -c '' 2>/dev/null || return 0
  "$here/check-png" "$@" || fail "picture"
}

# page DIRECTORY: its index.html is whole; see check-page. Nothing is looked at without python3.
page() {
  [ -s "$1/index.html" ] || fail "no page in $1"
  python3 -c '' 2>/dev/null || return 0
  "$here/check-page" "$1" || fail "page"
}

# is CSV COLUMN ROW VALUE TOLERANCE: the number in the named column of row ROW (1: the first one after
# the header; -1: the last one).
is() {
  awk -F, -v name="$2" -v row="$3" -v want="$4" -v off="$5" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i }
    NR == row + 1 { value = $column; found = column }
    NR > 1 { last = $column }
    END { if (row < 0) { value = last; found = column }
      print name " of row " row " = " value
      exit !(found && value ~ /^[-+0-9.eE]+$/ && (value - want) ^ 2 <= off ^ 2) }' "$1" ||
    fail "$2 of row $3 of $1, expected $4 +- $5"
}

# Of $pid, in s/100; nothing once it has ended.
processor_time() { awk '$3 != "Z" { print $14 + $15 }' "/proc/$pid/stat" 2>/dev/null || :; }
# used SECONDS: waits until $pid has had so much more of the processor, or has ended.
used() {
  until=$(awk "BEGIN { print int(100 * $1) + $(processor_time || echo 0) + 0 }")
  while now=$(processor_time) && [ -n "$now" ] && [ "$now" -lt "$until" ]; do sleep 0.02; done
}
