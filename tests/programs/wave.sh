#!/bin/sh
# wave.sh DIRECTORY DATA: short runs of mps-wave and what they write, against theory.
. "$(dirname "$0")/checks.sh"
wave=$1/mps-wave

# A pulse through 20 m of uniform ground between periodic sides: travel time and doubled peak.
out="$work/a dir with 'quotes'"
"$wave" --spacing 1 --width 4 --height 20 --duration 0.7 --courant 0.5 \
  --receivers 5 --out "$out" >"$work/log"
tail -n 1 "$work/log" | grep -q "surface peak .*theory .*travel time .*exact" || fail "last line"
in_range "$out/summary.json" travel_time_exact 0.19499 0.19501
in_range "$out/summary.json" travel_time 0.193 0.197
in_range "$out/summary.json" surface_peak 1.9 2.05
in_range "$out/summary.json" surface_peak_edge 1.9 2.05
in_range "$out/summary.json" particles 80 80
in_range "$out/summary.json" steps 300 400
has "$out/summary.json" '"wave": "S"'
has "$out/summary.json" '"outcome": "finished"'
head -n 1 "$out/receivers.csv" |
  grep -q '^t_s,ax_m_s2_GL-0.5m,.*,ax_m_s2_GL-19.5m,ax_m_s2_GL-0.5m_edge$' || fail "header"
awk -F, 'NF != 7 || /nan|inf/ { exit 1 }' "$out/receivers.csv" || fail "rows of receivers.csv"
picture "$out/wave.png" 1200x900 1f4e8c c0392b
page "$out"
has "$out/wave.gp" 'Verlet' # the integrator by its name
[ "$(find "$out" -name '*.part')" = "" ] || fail "temporary files are left"

# Layers on a half space; the height follows from the file. 4/100 + 6/200 + 10/300 s.
"$wave" --spacing 1 --layers "$2/layers.csv" --base viscous --sides freefield --courant 0.5 --duration 0.6 \
  --out "$work/layers" >/dev/null
in_range "$work/layers/summary.json" travel_time_exact 0.10333 0.10334
has "$work/layers/summary.json" '"energy_drift": null'

# The same layers by names in another order and in other units; a file without names is refused.
sed 's/[;,]/ /g' "$2/layers.csv" | awk '/^[0-9]/ { print $2 / .3048 ";" $5 * 100 ";" $1 ";" $4 ";" $3 }' |
  { echo 'Vs (ft/s);damping (%);thickness (m);unit weight (kN/m3);vp [m/s]'; cat; } >"$work/other.csv"
"$wave" --spacing 1 --layers "$work/other.csv" --base viscous --sides freefield --courant 0.5 --duration 0.6 \
  --out "$work/other" >/dev/null
for key in travel_time_exact surface_peak; do
  want=$(sed -n "s/^ *\"$key\": \([^,]*\),*$/\1/p" "$work/layers/summary.json")
  in_range "$work/other/summary.json" $key "$(awk -v x="$want" 'BEGIN { printf "%.9g", x * (1 - 1e-4) }')" \
    "$(awk -v x="$want" 'BEGIN { printf "%.9g", x * (1 + 1e-4) }')"
done
sed 1d "$2/layers.csv" | sed /vs_m_s/d >"$work/bare.csv"
"$wave" --layers "$work/bare.csv" --duration 0.01 --out "$work/bare" >/dev/null 2>"$work/log" && fail "layers without names"
has "$work/log" "bare.csv:1: a header is missing: a layer has thickness_m, vs_m_s, vp_m_s"

# A pulse in 8 m of ground on rock of 2, 5 and 20 times its impedance, which comes back from the free surface and the rock:
# the surface by d'Alembert, at 60 % of the first mode's frequency; largest difference of all times, with rows of 1, 0.5, 0.25 m.
# bounce WAVE VELOCITY RATIO SPACING MOST
bounce() {
  printf 'thickness_m,vs_m_s,vp_m_s,density_kg_m3,damping_ratio\n8,100,200,1800,0\ninf,%d,%d,1800,0\n' \
    $((100 * $3)) $((200 * $3)) >"$work/rock.csv"
  set -- "$@" $(awk "BEGIN { print $2 / 53, 80 / $2, 400 / $2 }")
  PATH=/nonexistent "$wave" --layers "$work/rock.csv" --spacing $4 --width 4 --base viscous --wave $1 --frequency $6 --peak-time $7 \
    --duration $8 --out "$work/rock" >/dev/null
  awk -F, -v v=$2 -v ratio=$3 -v d=$4 -v most=$5 -v wave=$1 '
    function pulse(t, q) { q = (3.14159265 * v / 53 * (t - 80 / v)) ^ 2; return q < 700 ? (2 * q - 1) * exp(-q) : 0 }
    NR == 1 && $NF !~ /edge/ || NR > 1 {
      r = (1 - ratio) / (1 + ratio); part = 2 * ratio / (1 + ratio); exact = 0
      for (k = 0; (2 * k + 1) * 8 / v < $1; k++) { # 0.5 d below the surface
        exact += part * (pulse($1 - ((2 * k + 1) * 8 - d / 2) / v) + pulse($1 - ((2 * k + 1) * 8 + d / 2) / v))
        part *= r }
      off = $2 - exact; if (off < 0) off = -off; if (off > worst) worst = off
      if (exact > peak) peak = exact; if (-exact > peak) peak = -exact }
    END { printf "%s, %d times, rows of %g m: within %.2f %% of %.2f m/s2\n", wave, ratio, d, 100 * worst / peak, peak
      exit !(worst < most * peak) }' "$work/rock/receivers.csv" || fail "ground on rock"
}
for ratio in 2 5 20; do
  bounce S 100 $ratio 1 0.035
  bounce S 100 $ratio 0.5 0.005
  bounce S 100 $ratio 0.25 0.001
  bounce P 200 $ratio 1 0.08
  bounce P 200 $ratio 0.5 0.016
  bounce P 200 $ratio 0.25 0.0035
done

# A soft seam thinner than the particles is not lost.
printf 'thickness_m,vs_m_s,vp_m_s,unit_weight_kN_m3,damping_ratio\n4,200,400,18,0.02\n0.4,40,400,16,0.02\n3.6,200,400,18,0.02\n' \
  >"$work/seam.csv"
sed 's/^0.4,40,400,16/0.4,200,400,18/' "$work/seam.csv" >"$work/firm.csv"
for ground in seam firm; do
  "$wave" --layers "$work/$ground.csv" --spacing 1 --width 4 --duration 0.3 --courant 0.5 --out "$work/$ground" \
    >/dev/null 2>"$work/log"
  has "$work/log" "layer 2 of $work/$ground.csv is 0.4 m thick, thinner than the particles, 1 m"
done
! cmp -s "$work/seam/receivers.csv" "$work/firm/receivers.csv" || fail "the seam is lost"

# P wave under rollers, energy kept after the input has ended.
"$wave" --spacing 2 --height 20 --wave P --sides roller --courant 0.2 --duration 1.5 --out "$work/p" >/dev/null
in_range "$work/p/summary.json" energy_drift 0 0.01

# Frames: as many as the option says, the first and the last of the run among them; one alone is the last.
for frames in 1 2 3; do
  "$wave" --width 4 --height 10 --duration 0.2 --dt 1e-3 --frames $frames --out "$work/frames" >/dev/null
  "$1/mps-info" "$work/frames/wave.vtkhdf" | tr -s '[:space:]' ' ' >"$work/info" || fail "mps-info"
  first=$([ $frames = 1 ] && echo 0.2 || echo 0)
  has "$work/info" "frames $frames first $first s last 0.2 s"
  rm -r "$work/frames"
done
# 60 steps, the last of which ends by 1.4e-12 s before the duration.
"$wave" --spacing 1 --width 4 --height 10 --duration 0.2 --dt 0.00333333333331 --frames 3 --out "$work/frames" >/dev/null
"$1/mps-info" "$work/frames/wave.vtkhdf" | tr -s '[:space:]' ' ' >"$work/info" || fail "mps-info"
has "$work/info" "frames 3 first 0 s last 0.2 s"
rm -r "$work/frames"

# A slope writes its crest and toe.
"$wave" --spacing 2 --width 40 --height 20 --incline 15,25,12 --courant 0.5 \
  --duration 0.3 --out "$work/slope" >/dev/null
head -n 1 "$work/slope/slope.csv" | grep -q 'crest.*toe' || fail "header of slope.csv"
[ "$(wc -l <"$work/slope/peaks.csv")" -eq "$(($(sed -n 's/.*"particles": \([0-9]*\).*/\1/p' \
  "$work/slope/summary.json") - 10 - 6 + 1))" ] || fail "peaks.csv: all but the two columns"

# A run that is cut in two at a checkpoint ends with the results of one in one piece, the travel time
# too, right after the restart; another model is refused by the name of the option.
whole="--spacing 2 --height 20 --damping 0.02 --courant 0.5"
if "$wave" $whole --duration 0.6 --frames 6 --out "$work/cut" >"$work/log" 2>&1; then
  [ -s "$work/cut/wave.vtkhdf" ] || fail "wave.vtkhdf"
  "$1/mps-info" "$work/cut/checkpoint.h5" | tr -s '[:space:]' ' ' >"$work/info" || fail "mps-info"
  has "$work/info" "options spacing 2 width 10 height 20"
  has "$work/info" "record ricker frequency 4"
  has "$work/info" "dt not given courant 0.5 duration 0.6"
  cp "$work/cut/summary.json" "$work/first.json"
  cp "$work/cut/wave.vtkhdf" "$work/first.vtkhdf"
  "$wave" $whole --duration 0.9 --out "$work/whole" >/dev/null
  # Into a directory that has results: they stay, and those of the run that goes on are beside them.
  "$wave" $whole --duration 0.9 --frames 6 --restart "$work/cut/checkpoint.h5" --out "$work/cut" >"$work/log"
  on=$(sed -n 's/^Results go to //p' "$work/log")
  [ "$on" != "$work/cut" ] && [ -d "$on" ] || fail "restart: $on"
  cmp "$on/receivers.csv" "$work/whole/receivers.csv" || fail "restart: other rows"
  cmp "$work/cut/summary.json" "$work/first.json" || fail "restart: the first summary is gone"
  if "$wave" $whole --duration 0.9 --restart "$work/cut/checkpoint.h5" --out "$work/cut" 2>"$work/log"; then
    fail "restart: twice into one directory"
  fi
  has "$work/log" "have results already: --out must be another directory"
  cmp "$work/cut/wave.vtkhdf" "$work/first.vtkhdf" || fail "restart: the first frames are gone"
  grep travel_time "$on/summary.json" >"$work/a"
  grep travel_time "$work/whole/summary.json" >"$work/b"
  cmp "$work/a" "$work/b" || fail "restart: another travel time"
  grep -q '"travel_time": null' "$work/b" && fail "no travel time"
  for other in "--height 40" "--vs 90" "--unit-weight 15kN/m3" "--damping 0.03" "--acceleration 2"; do
    others=$(printf '%s\n' "$whole" | sed "s/${other%% *} [^ ]*//")
    "$wave" $others $other --restart "$work/cut/checkpoint.h5" --out "$work/rest" 2>"$work/log" &&
      fail "a checkpoint of another model was taken: $other"
    has "$work/log" "made with other options: ${other%% *}"
    [ "$(wc -l <"$work/log")" -eq 1 ] || fail "one line for one error: $other"
  done
else
  has "$work/log" "HDF5" # built without
fi

# The two forms of damping: one result with one h, two where h changes.
printf 'thickness_m,vs_m_s,vp_m_s,unit_weight_kN_m3,damping_ratio\n10,100,200,18,0.05\n10,200,400,18,0.0%d\n' 5 >"$work/5.csv"
sed 's/0\.05$/0.01/; 2s/0\.01$/0.05/' "$work/5.csv" >"$work/1.csv"
for h in 5 1; do
  for form in pair particle; do
    "$wave" --layers "$work/$h.csv" --spacing 2 --width 4 --duration 0.6 --damping-form $form --out "$work/$form" >/dev/null
    sed -n 's/.*"surface_peak": \([0-9.]*\),.*/\1/p' "$work/$form/summary.json" >"$work/peak-$form"
  done
  cat "$work/peak-pair" "$work/peak-particle" | awk -v h=$h 'NR == 1 { a = $1 } NR == 2 { d = a - $1; if (d < 0) d = -d
    exit !(NR == 2 && (h == 5 ? d < 1e-9 * a : d > 1e-4 * a)) }' || fail "forms of damping, h $h: $(cat "$work/peak-pair" "$work/peak-particle")"
done

# Without gnuplot: a note, and no error.
PATH=/nonexistent "$wave" --spacing 2 --duration 0.3 --dt 2e-4 --integrator euler --out "$work/p" \
  >"$work/log"
has "$work/p/wave.gp" 'Euler'
has "$work/log" "gnuplot is not installed"
