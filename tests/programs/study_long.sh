#!/bin/sh
# study_long.sh DIRECTORY: the paper's 320 cases by time stepping and by linear theory (minutes).
. "$(dirname "$0")/checks.sh"

# f1 + f2 = 15 Hz suits the criterion 2.2 m/s2: regression against Table 2 within 6 %.
"$1/mps-stability" --study --method both --accuracy 1.05 --f2 14 --out "$work/study" >/dev/null
in_range "$work/study/summary.json" rms_table2_stepping_S 0 0.06
in_range "$work/study/summary.json" rms_table2_stepping_P 0 0.06
in_range "$work/study/summary.json" stepping_over_linear_max 0.95 1.3
# No case may run stably far above linear theory, or fail far below it.
awk -F, 'NR > 1 && ($6 < 0.93 * $5 || $6 > 1.3 * $5) { print; bad = 1 } END { exit bad }' \
  "$work/study/limits.csv" || fail "stepping and linear limits disagree"
