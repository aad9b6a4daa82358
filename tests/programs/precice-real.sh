#!/bin/sh
# precice-real.sh PROGRAM PARTNER CONFIG: mps-precice by preCICE itself, beside another process: a flap of 1 m under a
# uniform pressure of 10 Pa from one moment on, alone and on a foundation that halves its first mode's response.
# Timoshenko's beam has 3.451e-3 m in statics and half a period of .809 s; the peak is twice the static deflection, and a
# few percent more by higher modes. With the foundation they are half as large and .572 s. SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
program=$(realpath "$1") partner=$(realpath "$2") config=$(realpath "$3")
cd "$work"
sed 's/max-time value="[^"]*"/max-time value="1"/' "$config" >config.xml

# flap FOUNDATION DT: both participants
flap() {
  rm -rf precice-run flap
  timeout 1200 "$partner" config.xml 10 "$1" >partner.log 2>&1 &
  other=$!
  timeout 1200 "$program" --config config.xml --dt "$2" --threads 1 --out flap >solid.log 2>&1 || fail "$(tail -5 solid.log)"
  wait $other || fail "partner: $(tail -5 partner.log)"
  in_range flap/summary.json windows 100 100
}
flap 0 10ms
in_range flap/summary.json tip_largest_m 6.85e-3 7.2e-3
in_range flap/summary.json tip_largest_time_s .79 .83
flap 4528 4ms # 3 steps a window
in_range flap/summary.json steps 300 3000
in_range flap/summary.json tip_largest_m 3.42e-3 3.6e-3
in_range flap/summary.json tip_largest_time_s .55 .59

# names that the configuration lacks are refused before the other participant is waited for
for wrong in "--data Nothing" "--displacement Nothing" "--coupling-mesh Other" "--participant Nobody"; do
  status=0
  timeout 1200 "$program" --config config.xml $wrong --out none >wrong.log 2>&1 || status=$?
  [ $status -ne 0 ] && [ $status -ne 124 ] || fail "$wrong: exit code $status"
  grep -q "${wrong#* }" wrong.log || fail "$wrong: $(cat wrong.log)"
done
status=0
"$program" --config nowhere.xml --out none 2>wrong.log || status=$?
[ $status -eq 1 ] || fail "no configuration: exit code $status"
has wrong.log "nowhere.xml"
