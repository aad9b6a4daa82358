#!/bin/sh
# flume.sh DIRECTORY: mps-flume on coarse particles: regular waves and a sea against their targets, still
# water before a dike, a caisson that waves pass, a restart, refusals.
# SPDX-License-Identifier: BSD-3-Clause
. "$(dirname "$0")/checks.sh"
coarse="--spacing 0.05 --threads 1"

# Regular waves between two absorbing pistons.
"$1/mps-flume" $coarse --length 5 --height 0.1 --duration 12 --frames 0 --out "$work/a" >"$work/log"
s=$work/a/summary.json
in_range "$s" H_incident 0.09 0.105
in_range "$s" Hm0_target 0.140 0.143
in_range "$s" reflection 0 0.06
in_range "$s" reflection_theory 0.001 0.003
in_range "$s" mean_level -0.002 0.0005 # -.0033 by the levels at the faces of the pistons
in_range "$s" mean_maker -0.01 0.01
in_range "$s" mean_end -0.02 0.02 # the waves have just arrived there
in_range "$s" collisions 0 0
in_range "$s" time 11.999999 12.000001 # the last steps are shorter
has "$work/a/gauges.csv" "level_at_2.6_m"
for row in 1 2 3 4; do # waves one by one, all alike
  is "$work/a/waves.csv" waves $row 1.5 0.6 # the window is two periods
  is "$work/a/waves.csv" period_s $row 1.4 0.03
  is "$work/a/waves.csv" H_third_m $row 0.096 0.008
  is "$work/a/waves.csv" H_max_m $row 0.098 0.008
done
has "$work/a/force.csv" "t_s,maker_m,end_m"
picture "$work/a/levels.png" 0x0
picture "$work/a/water.png" 0x0

# A sea towards a caisson: rows of all tables, a discharge.
sea="--spacing 0.04 --threads 1 --waves jonswap --height 0.16 --wall caisson --length 3"
"$1/mps-flume" $sea --freeboard 0.08 --duration 16 --frames 3 --out "$work/b" >"$work/log"
s=$work/b/summary.json
in_range "$s" Hm0_incident 0.08 0.2
in_range "$s" q 1e-6 0.01
in_range "$s" q_eurotop 1e-6 0.01
has "$s" "waves: the formula's mean discharge is that of hundreds"
has "$s" '"force_goda": null' # of the highest of more waves than these
in_range "$s" force_peak 100 1500
has "$work/b/discharge.csv" "t_s,volume_m2,returned_m2,water_m2,head_m,thin_m2"
# Events too low for particles are beside what is counted, never in it.
awk -F, 'NR > 1 { if ($6 < last) exit bad = 1; last = $6; if ($5 > 0.052) high = 1 }
  END { print "thin " last " m2"; exit bad || !(last > 2e-4 && last < 0.01) || !high }' "$work/b/discharge.csv" ||
  fail "the flow of low heads falls, or there is none, or no head is above 1.3 spacings"
in_range "$s" q_thin 1e-6 0.001
in_range "$s" thin_events 1 9
awk -F: '/"q"/ { q = $2 + 0 } /"q_thin"/ { t = $2 + 0 } /"q_with_thin"/ { s = $2 + 0 }
  END { exit (s - q - t) ^ 2 > 1e-18 }' "$s" || fail "q_with_thin is not q + q_thin"
has "$work/log" "with events too low for particles"
books() { # TABLE: the water of the start is in the flume, or has passed and not returned, at all times
  awk -F, 'NR > 1 { off = $2 - $3 + $4 - 1.2; n++; if (off ^ 2 > 1e-12) exit bad = 1; if ($3 > most) most = $3 }
    END { print n " rows, returned " most " m2"; exit bad || n < 100 }' "$1" || fail "water is lost in $1"
}
books "$work/b/discharge.csv"
in_range "$s" volume_returned 0.0015 0.02
in_range "$s" water_mean 0.99 1.001
in_range "$s" mean_level -0.02 0.01
has "$work/b/events.csv" "begins_s,ends_s,volume_m2"
has "$work/b/spectrum.csv" "frequency_Hz,incident_m2_s,reflected_m2_s,target_m2_s"
for name in levels spectrum force discharge water; do picture "$work/b/$name.png" 0x0; done

# Still water before a dike: rho g d^2/2.
"$1/mps-flume" --spacing 0.025 --threads 1 --height 1e-5 --wall slope --length 1.5 --duration 1.5 --frames 0 \
  --out "$work/still" >"$work/log" 2>&1
is "$work/still/force.csv" force_N -1 784.8 16
is "$work/still/runup.csv" run_up_m -1 0 0.0125 # half a spacing
! grep -q thin_m2 "$work/still/discharge.csv" || fail "a flow of low heads over a dike"
has "$work/log" "lower than 4 spacings of 0.025 m: of the water that passes the crest small events will be lost"

# A solitary wave keeps height and speed; its piston leaves little behind.
"$1/mps-flume" $coarse --waves solitary --height 0.12 --length 13 --gauge 0.8,2,4 --duration 8.5 --frames 0 \
  --out "$work/solitary" >"$work/log"
s=$work/solitary/summary.json
in_range "$s" crest_last 0.114 0.126
in_range "$s" wave_speed 2.2 2.32
in_range "$s" wave_speed_theory 2.258 2.259
in_range "$s" trailing 0 0.05
has "$work/log" "asked for; speed"

# A zone before the far end; a focused group; a record.
"$1/mps-flume" $coarse --length 5 --height 0.1 --duration 13 --absorb zone --frames 0 --gauge 0.8,1.2,1.5,2,2.4 \
  --out "$work/zone" >"$work/log"
in_range "$work/zone/summary.json" reflection 0 0.1
in_range "$work/zone/summary.json" harmonic_stokes 0.15 0.18
in_range "$work/zone/summary.json" harmonic_bound 0.13 0.20
in_range "$work/zone/summary.json" harmonic_free 0 0.02 # .03 with --order linear
in_range "$work/zone/summary.json" wave_length_measured 2.3 2.5
has "$work/log" "second harmonic over the first"
"$1/mps-flume" $coarse --waves focused --focus 2,6 --height 0.15 --length 4 --duration 2 --frames 0 \
  --out "$work/focus" >"$work/log" 2>&1
awk 'BEGIN { print "time (s),WG1 (mm)"; for (k = 0; k <= 400; k++) printf "%g,%g\n", 0.05 * k, 40 * cos(4.5 * 0.05 * k) }' \
  >"$work/record.csv"
"$1/mps-flume" $coarse --waves file --levels "$work/record.csv" --period 1.4 --length 3 --duration 2 --frames 0 \
  --out "$work/file" >"$work/log" 2>&1

has "$work/log" "record.csv: CSV, 401 values, step 0.05 s, length 20 s, peak 0.04 m (40 mm)"
in_range "$work/file/summary.json" record_peak 0.04 0.04
in_range "$work/file/summary.json" stroke 0.01 0.06
! grep -q "the record" "$work/log" || fail "a warning of a record that the maker makes"
"$1/mps-flume" $coarse --waves file --levels "$work/record.csv" --period 0.5 --length 0.5 --duration 0.1 --frames 0 \
  --out "$work/file" >"$work/log" 2>&1
has "$work/log" "the record has Hm0 0.11"

# A sea of long waves, and one whose highest waves break; a focus that comes too early.
short="--spacing 0.05 --threads 1 --length 5 --duration 0.05 --sample 0.05 --frames 0 --out $work/short"
"$1/mps-flume" $short --waves jonswap --height 0.06 --period 3 --depth 0.25 >"$work/log" 2>&1
has "$work/log" "from 26.3 on second order does not hold"
"$1/mps-flume" $short --waves pm --height 0.2 >"$work/log" 2>&1
has "$work/log" "0.36 m (1.8 Hm0), are above the breaking height 0.27 m"
"$1/mps-flume" $short --waves focused --height 0.1 --focus 3,4 >"$work/log" 2>&1
has "$work/log" "the focus at 4 s is too early: the waves of the peak need 5"

# What the library says of its choices is said by the options.
refuse_waves() { # TEXT OPTIONS
  text=$1
  shift
  code=0
  "$flume" --spacing 0.05 --length 5 --duration 0.05 --out "$work/refused" "$@" >"$work/log" 2>&1 || code=$?
  [ $code -ne 0 ] || fail "no error of $*"
  has "$work/log" "$text"
}
flume=$1/mps-flume
refuse_waves "must be below 26.3 with --order second: longer waves are of --order stream" --height 0.08 --period 3 --depth 0.25
refuse_waves "--order stream is for --waves regular" --order stream --waves jonswap
refuse_waves "--order stream is for k depth <= 1: take --order second" --order stream --period 0.8 --height 0.03

# Regular waves too long for second order; steps.
"$1/mps-flume" $short --order stream --height 0.08 --period 3 --depth 0.25 >"$work/log" 2>&1
has "$work/log" "1 components, wave length 4.902 m"
has "$work/log" "dt 0.01428 s" # .2 (.05 m/g)^1/2
"$1/mps-flume" $short --dt 5ms >"$work/log" 2>&1
has "$work/log" "dt 0.005 s"
! "$1/mps-flume" $short --dt 30ms >"$work/log" 2>&1 || fail "a step of .42 (l0/g)^1/2"
has "$work/log" "--dt must be at most .3 (spacing/g)^1/2"

# Waves through a block of rock: the gauges before and behind it are analysed apart. Energy is lost.
"$1/mps-flume" $coarse --height 0.05 --period 1.5 --length 6 --rock 3,0,3.4,0,3.4,0.8,3,0.8 --stone 2cm --rock-beta 0 \
  --gauge 1,1.25,1.75,2.25,3.2,4,4.25,4.75 --duration 16 --frames 0 --out "$work/block" >"$work/log" 2>&1
s=$work/block/summary.json
in_range "$s" reflection 0.40 0.65
in_range "$s" transmission 0.40 0.65
in_range "$s" reflection_behind 0 0.08
has "$work/log" "the gauge at 3.2 m lies between the ends of structure, rock, a bed that is not level, or zone"
has "$s" '"loss_per_wavelength": null'
has "$s" '"harmonic_bound": null'

# Before a wall the maker absorbs what that sends back, however far it is: the incident waves are as high 1.63 and 1.88
# wave lengths away, where what a maker sent back would be in phase and against it.
for l0 in 0.05 0.04 0.0333333333; do
  for toe in 3.9 4.5; do
    "$1/mps-flume" --height 0.08 --wall vertical --spacing $l0 --length $toe --duration 20 --window 9,20 --frames 0 \
      --threads 1 --out "$work/toe" >"$work/log" 2>&1
    in_range "$work/toe/summary.json" H_incident 0.0740 0.0815 # .0723 to .0832 with .06 sent back
  done
done

# A window of two periods, whose ends differ by a little less in floating point.
"$1/mps-flume" --period 0.7 --height 0.03 --spacing 0.05 --length 5 --window 0.7,2.1 --duration 2.1 --frames 0 \
  --threads 1 --out "$work/two" >"$work/log" 2>&1
! grep -q "too short" "$work/log" || fail "two periods are too short"

# Run-up of a solitary wave on 1:2.5, Synolakis' 2.831 cot(angle)^1/2 (H/d)^5/4 d = .180 m.
for l0 in 0.03 0.025 0.02; do
  "$1/mps-flume" --waves solitary --depth 0.3 --height 0.06 --wall slope --slope 2.5 --freeboard 0.3 --length 3 \
    --spacing $l0 --duration 5 --frames 0 --threads 1 --out "$work/climb" >"$work/log" 2>&1
  in_range "$work/climb/summary.json" run_up_highest 0.162 0.198
  has "$work/log" "run-up: highest 0.1"
done

# Breakers on 1:4 throw particles over a crest three wave heights up, which water does not pass; over a low dike it flows.
"$1/mps-flume" --depth 0.5 --height 0.1 --period 1.6 --wall slope --slope 4 --freeboard 0.3 --spacing 0.03125 --duration 14 \
  --length 4 --frames 0 --threads 1 --out "$work/thrown" >"$work/log" 2>&1
s=$work/thrown/summary.json
thrown=$(sed -n 's/.*"q_thrown": \([^,]*\),*$/\1/p' "$s")
in_range "$s" q_thrown 1e-5 1e-2
in_range "$s" q "$thrown" "$thrown"
has "$work/log" "without particles thrown over the crest 0 m2/s"
has "$s" "in particles that breakers throw up, while the layer on the slope stayed below it"
"$1/mps-flume" --height 0.12 --period 1.6 --wall slope --slope 2 --freeboard 0.06 --spacing 0.04 --duration 13 --length 4 \
  --frames 0 --threads 1 --out "$work/flows" >"$work/log" 2>&1
s=$work/flows/summary.json
in_range "$s" q 1e-3 2e-2
in_range "$s" q_thrown 0 4e-4

# On from a checkpoint: the results of the run that never stopped.
run="$sea --freeboard 0.05 --duration 12 --frames 0"
"$1/mps-flume" $run --out "$work/c" >"$work/log" 2>&1
books "$work/c/discharge.csv"
in_range "$work/c/summary.json" volume_returned 0.006 0.1
"$1/mps-flume" $sea --freeboard 0.05 --duration 8 --frames 0 --passed leaves --out "$work/leaves" >"$work/log" 2>&1
books "$work/leaves/discharge.csv"
in_range "$work/leaves/summary.json" volume 0.003 0.1
in_range "$work/leaves/summary.json" volume_returned 0 0
if [ -f "$work/b/water.vtkhdf" ]; then # built with HDF5
  "$1/mps-flume" $run --every-checkpoint 5.5 --checkpoint "$work/d.h5" --out "$work/d" >"$work/log" 2>&1
  "$1/mps-flume" $run --restart "$work/d.h5" --out "$work/e" >"$work/log" 2>&1
  for file in gauges.csv force.csv discharge.csv water.bin summary.json; do
    cmp "$work/c/$file" "$work/e/$file" || fail "another $file after a restart"
  done
  if "$1/mps-flume" $run --restart "$work/d.h5" --seed 2 --out "$work/f" 2>"$work/log"; then
    fail "a restart with another --seed"
  fi
  has "$work/log" "--seed is 2"
fi

# Still water bears on a slope what it must from the first step on, wherever the slope cuts the lattice:
# 784.8 N/m before .4 m of water; with eight particles over the depth it is within 1.5 %. Waves of a
# hundredth of a millimetre do not show.
for case in "0.5 0.05 0.015" "1 0.025 0.005" "1.37 0.05 0.015" "2 0.05 0.015" "2 0.0125 0.005" "3 0.025 0.005" "6 0.025 0.005"; do
  set -- "$1" $case
  "$1/mps-flume" --wall slope --slope "$2" --freeboard 0.2 --depth 0.4 --length 1.2 --spacing "$3" --height 1e-5 \
    --duration 0.3 --sample 0.005 --frames 0 --threads 1 --out "$work/rest-$2-$3" >"$work/log"
  awk -F, -v case="$2, $3" -v bound="$4" '
    NR == 1 { for (i = 1; i <= NF; i++) if ($i == "force_N") f = i }
    NR > 1 { if (!n++ || $f > most) most = $f; if (n == 1 || $f < least) least = $f; sum += $f }
    END { print "slope, spacing " case ": force " least " to " most ", mean " sum / n
          off = sum / n / 784.8 - 1
          exit !(f && n > 20 && least > 0.98 * 784.8 && most < 1.02 * 784.8 && off * off < bound * bound) }' \
    "$work/rest-$2-$3/force.csv" || fail "still water before a slope"
done
