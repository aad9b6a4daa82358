#!/bin/sh
# footing_long.sh DIRECTORY: bearing capacity of the footing on cohesive and on frictional ground at
# two spacings (minutes); the error is of first order in h, so the extrapolation is close to the
# exact value.
. "$(dirname "$0")/checks.sh"

for h in 0.1 0.05; do
  "$1/mps-footing" --cell $h --soil 3x2 --rate 5mm/s --flip-time 10ms --out "$work/$h" >/dev/null
done
in_range "$work/0.1/summary.json" q_over_c 5.04 5.25
in_range "$work/0.05/summary.json" q_over_c 5.10 5.20
# A smooth circle, ten cells a radius: within 2 % of 5.69 (Shield).
"$1/mps-footing" --shape circle --cell 0.05 --soil 3x2 --rate 1mm/s --out "$work/circle" >/dev/null
in_range "$work/circle/summary.json" q_over_c 5.576 5.804

# extrapolated DIRECTORY KEY: from h = 0.1 and 0.05 in DIRECTORY, within 3 % of q_exact over c, 10 kPa.
extrapolated() {
  sed -n "s/^ *\"\($2\|q_exact\)\": \([^,]*\),*$/\1 \2/p" "$1/0.1/summary.json" "$1/0.05/summary.json" |
    awk '$1 == "q_exact" { exact = $2 / 10000; next } { coarse = fine; fine = $2 }
         END { q = 2 * fine - coarse; print "extrapolated " q ", exact " exact
               exit !(exact > 0 && q > 0.97 * exact && q < 1.03 * exact) }' || fail "$1"
}
extrapolated "$work" q_over_c

for mu in 0 0.6; do
  for h in 0.1 0.05; do
    "$1/mps-footing" --law druckerprager --friction $mu --cell $h --soil 5x2 --rate 5mm/s \
      --out "$work/$mu/$h" >/dev/null
  done
  extrapolated "$work/$mu" q_over_c_undeformed
done
