#!/bin/sh
# pile.sh DIRECTORY: mps-pile on a coarse grid: what must hold on any, and what it writes. The paper's
# size: docs/verification/wls-mpm/pile.md.
. "$(dirname "$0")/checks.sh"
coarse="--cell 0.02 --wall-thickness 0.04 --inner-diameter 0.16 --soil 0.4x0.5 --depth 0.2 --rate 0.5"

"$1/mps-pile" $coarse --rest 0.3 --threads 1 --out "$work/a" >"$work/log"
has "$work/log" "particles inside the wall: 0"
s=$work/a/summary.json
in_range "$s" particles_inside_pile 0 0
in_range "$s" deepest_inside_pile 0 0
in_range "$s" volume_ratio_max 1 1.02
in_range "$s" volume_ratio_min 0.3 1
in_range "$s" rest_speed 0 1e-3 # m/s: the soil rests before the pile comes
in_range "$s" depth 0.19999 0.20001
in_range "$s" nq_prandtl 48.9 48.95
in_range "$s" roughness 0 0.1
# 0.74 s in steps of 0.9 h/c, c = 30.6 m/s, and a little more where particles are fast or pressed.
in_range "$s" steps 1258 1289

# A part of the summary in a directory; $1 between $2 and $3 times $4.
value() { sed -n "s/^ *\"$2\": \([^,]*\),*\$/\1/p" "$work/$1/summary.json"; }
within() { awk -v x="$1" -v a="$2" -v b="$3" -v of="$4" 'BEGIN { exit !(x >= a * of && x <= b * of) }'; }

# What an engineer reckons. The tip: at least the N_q of a long footing at the surface (Prandtl), at most
# that with the factor of great depth (Brinch Hansen, 67), and half as much again on two cells. The
# shafts: from the active to the passive pressure of 38 degrees, 0.238 to 4.20, over K0 = 0.499.
bears() {
  in_range "$work/$1/summary.json" tip_nq 48.9 100
  within "$(value "$1" force_outside)" 0.476 8.42 "$(k0_shaft 0.12 0.2)" || fail "$1: the outer shaft"
  within "$(value "$1" force_inside)" 0.476 8.42 "$(k0_shaft 0.08 "$(value "$1" plug_height)")" ||
    fail "$1: the inner shaft"
}
k0_shaft() { awk -v r="$1" -v z="$2" 'BEGIN { print 3.14159265 * r * 0.499 * 0.53 * 1600 * 9.81 * z * z }'; }
bears a
awk -F'[:,]' '/"force_total"/ { total = $2 } /"force_tip"|"force_inside"|"force_outside"/ { sum += $2 }
  END { exit !(total > 0 && (total - sum) ^ 2 < 1e-18 * total ^ 2) }' "$s" || fail "the parts' sum"
has "$work/a/load.csv" "depth_m,total_N,tip_N,inside_N,outside_N,total_smooth_N,"
has "$work/a/fields-4.csv" "r_m,z_m,mean_stress_kPa,deviatoric_stress_kPa,plastic_strain"
picture "$work/a/pile.png" 0x760 c0392b 1f4e8c 2e8b57 555555
page "$work/a"
for name in mean_stress deviatoric_stress shear_strain; do
  picture "$work/a/$name.png" 0x0
done

# The same for every number of threads; friction is all that the shafts bear.
"$1/mps-pile" $coarse --rest 0.3 --threads 3 --out "$work/b" >/dev/null
cmp "$work/a/load.csv" "$work/b/load.csv" || fail "three threads give another load.csv"
"$1/mps-pile" $coarse --friction 0 --frames 1 --threads 1 --out "$work/smooth" >/dev/null
in_range "$work/smooth/summary.json" force_inside -1e-9 1e-9
in_range "$work/smooth/summary.json" force_outside -1e-9 1e-9
# By springs, an independent way of contact: as much in all and at the tip, the plug as high
# within a third of a cell.
"$1/mps-pile" $coarse --contact penalty --rest 0.3 --frames 1 --threads 1 --out "$work/springs" >/dev/null
in_range "$work/springs/summary.json" particles_inside_pile 0 0
bears springs
for name in force_total force_tip; do
  within "$(value a $name)" 0.95 1.05 "$(value springs $name)" || fail "$name by impulses and by springs"
done
within "$(value a plug_height)" 0.93 1.07 "$(value springs plug_height)" || fail "plug_height by impulses and by springs"

# A checkpoint that cannot be written is noticed at the start.
status=0
"$1/mps-pile" $coarse --checkpoint "$work/nowhere/pile.h5" --out "$work/d" >/dev/null 2>"$work/log" ||
  status=$?
[ "$status" -eq 1 ] || fail "wrong path of the checkpoint: exit code $status"
[ "$(wc -l <"$work/log")" -eq 1 ] || fail "more than one line: $(cat "$work/log")"
if grep -q "HDF5" "$work/log"; then exit 0; fi # built without
has "$work/log" "nowhere/pile.h5"

# Stopped by Ctrl-C after its second checkpoint (or a little late), and gone on on other threads: the
# results of the run that never stopped.
inode() { ls -i "$work/pile.h5" 2>/dev/null || echo none; }
"$1/mps-pile" $coarse --rest 0.3 --checkpoint "$work/pile.h5" --every-checkpoint 20ms \
  --threads 1 --out "$work/d" >/dev/null 2>"$work/log" &
pid=$!
until [ -f "$work/pile.h5" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.02; done
first=$(inode)
until [ "$(inode)" != "$first" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.02; done
kill -INT "$pid" 2>/dev/null || :
wait "$pid" || :
"$1/mps-pile" $coarse --rest 0.3 --restart "$work/pile.h5" --threads 2 --out "$work/e" >/dev/null
for file in load.csv summary.json fields-1.csv fields-4.csv; do
  cmp "$work/a/$file" "$work/e/$file" || fail "another $file after a restart"
done
if "$1/mps-pile" $coarse --rest 0.2 --restart "$work/pile.h5" --out "$work/f" 2>"$work/log"; then
  fail "a restart with another --rest"
fi
has "$work/log" "pile.h5 was made with other options: --rest is 0.2, was 0.3"
[ "$(wc -l <"$work/log")" -eq 1 ] || fail "more than one line: $(cat "$work/log")"

# A checkpoint that fails on the way is told and does not end the run: all results are there.
mkdir "$work/disk"
"$1/mps-pile" $coarse --checkpoint "$work/disk/pile.h5" --every-checkpoint 40ms --frames 1 \
  --threads 1 --out "$work/g" >"$work/out" 2>"$work/log" &
pid=$!
until [ -f "$work/disk/pile.h5" ] || ! kill -0 "$pid" 2>/dev/null; do sleep 0.02; done
mv "$work/disk" "$work/gone"
status=0
wait "$pid" || status=$?
[ "$status" -eq 1 ] || fail "checkpoint lost on the way: exit code $status"
[ "$(grep -c "no checkpoint is written, the run goes on: .*disk/pile.h5" "$work/log")" -eq 1 ] ||
  fail "lost checkpoint: $(cat "$work/log")"
in_range "$work/g/summary.json" depth 0.19999 0.20001
[ -s "$work/g/load.csv" ] || fail "no load.csv"
