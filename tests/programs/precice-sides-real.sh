#!/bin/sh
# precice-sides-real.sh BIN PRECICE: a wall of water and a rigid body in soil by preCICE itself; BIN has the programs, PRECICE
# the configurations (programs/precice).
#
# Water, .9 m deep, on one side of the flap (1 m, .1 m thick, E 1 GPa, nu .3, 3000 kg/m3), which stands straight at first.
# Ritz's method, Timoshenko's beam with the added mass of the layers coth(k L)/k: 2.4386e-3 m in statics, 50.00 rad/s (60.91
# dry). The force of the middle of a step, taken as that of its end, damps by omega^2 dt/4 m_a/(m + m_a) = .41 1/s.
# The box falls on soil as one whose mass is on its side of the coupling. SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
bin=$(realpath "$1") precice=$(realpath "$2")
cd "$work"

timeout 1200 "$bin/precice-water" --config "$precice/water-config.xml" --threads 1 --out water >water.log 2>&1 &
other=$!
timeout 1200 "$bin/mps-precice" --config "$precice/water-config.xml" --young 1GPa --dt 2ms --velocity Velocity --threads 1 --out flap \
  >solid.log 2>&1 || fail "$(tail -n 5 solid.log)"
wait $other || fail "water: $(tail -n 5 water.log)"
in_range flap/summary.json windows 200 200
in_range flap/summary.json steps 400 1200
in_range flap/summary.json tip_largest_m 4.75e-3 4.95e-3
in_range flap/summary.json tip_largest_time_s .06 .069
# the tip's rising passes of the static deflection are a period apart
awk -F, -v rest=2.4386e-3 '
  NR > 2 && last < rest && $2 >= rest { t[n++] = $1 - ($1 - before) * ($2 - rest) / ($2 - last) }
  NR > 1 { before = $1; last = $2; if ($1 > .126 && $1 < .38 && $2 > top) top = $2 }
  END { omega = 6.2831853 * (n - 1) / (t[n - 1] - t[0])
    print "omega " omega " rad/s, peak after the first " top " m"
    exit !(n == 3 && omega > 49 && omega < 51.5 && top < 4.86e-3 && top > 4.5e-3) }' flap/tip.csv || fail "the flap's period"

"$bin/precice-soil" --free --threads 1 --out free
timeout 1200 "$bin/precice-box" "$precice/soil-config.xml" >box.log 2>&1 &
other=$!
timeout 1200 "$bin/precice-soil" --config "$precice/soil-config.xml" --threads 1 --out soil >soil.log 2>&1 || fail "$(tail -n 5 soil.log)"
wait $other || fail "box: $(tail -n 5 box.log)"
for run in free soil; do # fallen and tilted, with the mass there or here: 1 micrometre of 26 mm
  is $run/box.csv t_s -1 .15 1e-9
  is $run/box.csv x_m -1 .025843 2e-6
  is $run/box.csv y_m -1 -.014402 2e-6
  is $run/box.csv angle_rad -1 -.12321 1e-5
done
status=0
timeout 1200 "$bin/precice-soil" --config "$precice/soil-config.xml" --force Nothing --out none >wrong.log 2>&1 || status=$?
[ $status -ne 0 ] && [ $status -ne 124 ] || fail "a name that the configuration lacks: exit code $status"
has wrong.log Nothing
