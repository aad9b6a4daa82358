#!/bin/sh
# stability.sh DIRECTORY: the critical time step of single cases, and the study by linear theory.
. "$(dirname "$0")/checks.sh"
stability=$1/mps-stability

# The spin mode: omega = sqrt(24) Vs / D, so dt = 2 / omega = 4.082e-3 s on an endless lattice; the
# paper's column ran with 4.1e-3 s and diverged with 4.2e-3 s.
"$stability" --spacing 1 --vs 100 --vp 200 --out "$work/one" >"$work/log"
in_range "$work/one/summary.json" dt_linear 4.08e-3 4.13e-3
in_range "$work/one/summary.json" dt_stepping 4.05e-3 4.15e-3
tail -n 1 "$work/log" | grep -q "critical dt: .*linear theory, .*time stepping" || fail "last line"

# R = 1.6 m: 3 x 31 particles.
"$stability" --spacing 3.2 --damping 0.048 --method linear --out "$work/two" >/dev/null
in_range "$work/two/summary.json" particles 93 93
has "$work/two/summary.json" '"dt_stepping": null'

"$stability" --study --method linear --out "$work/study" >/dev/null
[ "$(wc -l <"$work/study/limits.csv")" -eq 321 ] || fail "limits.csv"
# Through the regression, as the paper's table is one; with f1 + f2 = 16 Hz, the default.
in_range "$work/study/summary.json" rms_table2_S 0 0.035
in_range "$work/study/summary.json" rms_table2_P 0 0.035
in_range "$work/study/summary.json" rms_table2_cases_S 0 0.15
in_range "$work/study/summary.json" rms_table2_cases_P 0 0.15
for figure in 03 04 05 06 07 08 09 10; do
  picture "$work/study/fig$figure.png" 0x0
done
page "$work/study"
