#!/bin/sh
# footing_long.sh DIRECTORY: bearing capacity of the von Mises footing at two spacings (minutes);
# the error is of first order in h, so the extrapolation is close to 2 + pi.
. "$(dirname "$0")/checks.sh"

for h in 0.1 0.05; do
  "$1/mps-footing" --h $h --width 3 --depth 2 --rate 5 --out "$work/$h" >/dev/null
done
in_range "$work/0.1/summary.json" q_over_c 5.14 6.15
in_range "$work/0.05/summary.json" q_over_c 5.14 5.75
