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
