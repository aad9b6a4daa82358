#!/bin/sh
# plots.sh DIRECTORY SHARE: pictures by templates: the scale of colours, templates of one's own, drawing again by hand,
# and a program that finds no template.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
plots=$2/plots
command -v gnuplot >/dev/null || exit 0

# scale LEAST MOST LOWEST HIGHEST RANGE TICS: ends of a scale of colours beyond which there are values are marked, the
# others are not.
scale() {
  cat >"$work/scale.gp" <<END
width = 100; height = 100; picture = '$work/scale.png'
load '$plots/style.gp'
cb_least = $1; cb_most = $2; cb_lowest = $3; cb_highest = $4
eval colours
show cbrange
show cbtics
END
  gnuplot "$work/scale.gp" >"$work/scale" 2>&1 || fail "scale: $(cat "$work/scale")"
  has "$work/scale" "cbrange [ $5 ]"
  has "$work/scale" "$6"
}
scale 0 1.9 0 2.5 "0.00000 : 2.00000" '("0" 0.00000, "0.5" 0.500000, "1" 1.00000, "1.5" 1.50000, "≥ 2" 2.00000)'
scale -1 2 -1.5 2 "-1.00000 : 2.00000" '("≤ -1" -1.00000, "-0.5" -0.500000, "0" 0.00000, "0.5" 0.500000, "1" 1.00000, "1.5" 1.50000, "2" 2.00000)'
scale 3 3 3 3 "3.00000 : 4.00000" '"3"'

# Every template has the common style.
find "$plots" -name '*.gp' ! -name style.gp >"$work/list"
while read -r name; do
  [ "$(grep -c "^load 'style.gp'$" "$name")" -eq 1 ] || fail "$name does not load style.gp"
done <"$work/list"

disc="mps-rolling-disc --cell 0.025 --duration 0.05 --threads 1"
mkdir "$work/mine" "$work/bin"
sed "s/blue = '#1f4e8c'/blue = '#00aa00'/" "$plots/style.gp" >"$work/mine/style.gp"
MPS_PLOTS="$work/mine" "$1"/$disc --out "$work/t" >/dev/null
picture "$work/t/motion.png" 1000x640 00aa00 c0392b
rm "$work/t/motion.png"
(cd "$work/t" && sed -i "s/#00aa00/#1f4e8c/" motion.gp && gnuplot motion.gp)
picture "$work/t/motion.png" 1000x640 1f4e8c c0392b
cp "$1/mps-rolling-disc" "$work/bin"
rm "$work/t"/motion.*
"$work/bin"/$disc --out "$work/t" >"$work/out" || fail "no template: $(cat "$work/out")"
if grep -q "No pictures: the template style.gp of libmps is not found: set MPS_PLOTS to its folder" "$work/out"; then
  [ ! -e "$work/t/motion.gp" ] && [ -s "$work/t/motion.csv" ] || fail "files without a template"
  page "$work/t"
else
  [ -s "$work/t/motion.png" ] || fail "no picture by an installed template"
fi
