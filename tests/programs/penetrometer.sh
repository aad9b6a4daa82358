#!/bin/sh
# penetrometer.sh DIRECTORY: mps-penetrometer on coarse grids: space against axisymmetry, the parts'
# sum, a mesh, a whole model. Finer: docs/verification/wls-mpm/penetration.md.
. "$(dirname "$0")/checks.sh"
# On four cells a radius of 0.6 of them is a third of the tip's: its edges stay sharp.
many="--cell 0.025 --soil 0.3x0.3x0.25 --rate 1 --corner 0"
coarse="$many --threads 1"

"$1/mps-penetrometer" $coarse --depth 0.1 --friction 0.2 --also-axisymmetric --out "$work/a" >"$work/log"
has "$work/log" "particles inside the tip: 0"
s=$work/a/summary.json
in_range "$s" particles_inside 0 0
in_range "$s" deepest_inside 0 0
in_range "$s" volume_ratio_max 1 1.1
in_range "$s" volume_ratio_min 0.8 1
in_range "$s" depth 0.09999 0.10001
# At least a rough circle on the surface, 6.05; at most the cavity of a deep rough cone (Ladanyi and
# Johnston), 4/3 (1 + ln 100) + sqrt(3) = 9.2, under a tip that is a cell wider: (1 + 1/4)^2.
in_range "$s" n_factor 6.05 14.4
in_range "$s" space_over_axisymmetric 0.94 1.10
awk -F'[:,]' '/"force_total"/ { total = $2 } /"force_tip"|"force_shaft"/ { sum += $2 }
  END { exit !(total > 0 && (total - sum) ^ 2 < 1e-18 * total ^ 2) }' "$s" || fail "the parts' sum"
for file in force force-axisymmetric; do
  has "$work/a/$file.csv" "depth_m,total_N,tip_N,shaft_N,total_smooth_N,"
done
has "$work/a/section.csv" "x_m,z_m,displacement_m,plastic_strain"
picture "$work/a/force.png" 1000x680 1f4e8c c0392b
picture "$work/a/section.png" 0x800 555555 e6ebf1 6baed6

# The same for every number of threads.
"$1/mps-penetrometer" $many --symmetry quarter --threads 3 --depth 0.1 --friction 0.2 --out "$work/b" >/dev/null
cmp "$work/a/force.csv" "$work/b/force.csv" || fail "three threads give another force.csv"

# A sphere presses elastic ground as Hertz says, and more in so small a box: on a layer of that depth
# 1.135 times on a smooth floor, 1.159 on a rough one (Dimitriadis et al., 2002); the sides are as near
# again, and on five cells the sphere is half a cell larger, 1.05. The whole model is four quarters
# within what the sweeps over the contacts leave: rollers are mirrors.
sphere="--symmetry quarter --tip sphere --law elastic --poisson 0.3 --diameter 1 --cell 0.1 --soil 1.6x1.6x1 --depth 0.05"
"$1/mps-penetrometer" $sphere --threads 1 --out "$work/q" >/dev/null
"$1/mps-penetrometer" ${sphere#--symmetry quarter} --threads 3 --symmetry whole --out "$work/w" >/dev/null
has "$work/q/summary.json" '"force_hertz": null' # such a box is no half space
has "$work/q/summary.json" '"force_hertz_reason": "the '
# 4/3 E/(1 - nu^2) sqrt(R) d^1.5, E = 2.8 MPa, of d from 0.04 to 0.05 m
hertz=$(awk 'BEGIN { print 4 / 3 * 2.8e6 / 0.91 * sqrt(0.5) * 0.4 * (0.05 ^ 2.5 - 0.04 ^ 2.5) / 0.01 }')
in_range "$work/q/summary.json" force_total "$(awk "BEGIN { print 1.134 * $hertz }")" "$(awk "BEGIN { print 1.366 * $hertz }")"
force=$(sed -n 's/^ *"force_total": \([^,]*\),*$/\1/p' "$work/q/summary.json")
in_range "$work/w/summary.json" force_total \
  "$(awk "BEGIN { printf \"%.17g\", $force * (1 - 4e-3) }")" "$(awk "BEGIN { printf \"%.17g\", $force * (1 + 4e-3) }")"

# A blunt cone on D/8: faces end before their edges, and q is within 2 % of that on D/16, 8.52 c
# (verification); with sharp edges 10.8.
blunt="--soil 0.6x0.6x0.5 --depth 0.2 --apex-angle 120"
"$1/mps-penetrometer" $blunt --threads 1 --out "$work/blunt" >/dev/null
in_range "$work/blunt/summary.json" n_factor 8.35 8.69
in_range "$work/blunt/summary.json" particles_inside 0 0
# What transfers take is kept for D/(40 rate): without that the same cone bears 8.66 c.
in_range "$work/blunt/summary.json" flip_time 0.00999999 0.01000001
"$1/mps-penetrometer" $blunt --threads 1 --flip-time 0 --out "$work/blunt0" >/dev/null
in_range "$work/blunt0/summary.json" n_factor 8.5 8.85
in_range "$work/q/summary.json" flip_time 0 0
"$1/mps-penetrometer" $blunt --threads 3 --out "$work/blunt3" >/dev/null
cmp "$work/blunt/force.csv" "$work/blunt3/force.csv" || fail "three threads give another force.csv"

# In clay far from the surface, from a hole that the cone fills: more than the cavity of a smooth cone, 4/3 (1 + ln Ir),
# and less than that of a rough one under a tip that is a cell wider, (1 + 1/4)^2 (4/3 (1 + ln Ir) + sqrt(3)); stiffer clay
# bears more.
deep="--cell 0.025 --corner 0 --rate 1 --threads 1"
for ir in 50 200; do
  "$1/mps-penetrometer" $deep --soil 0.8x0.8x0.6 --start 0.25 --depth 0.35 --sides free --law tresca --ir $ir --out "$work/$ir" >"$work/log"
  has "$work/log" "net cone factor N_kt"
  in_range "$work/$ir/summary.json" rigidity_index "$ir" "$ir.01"
  in_range "$work/$ir/summary.json" n_kt "$(awk "BEGIN { print 4 / 3 * (1 + log($ir)) }")" \
    "$(awk "BEGIN { print 1.5625 * (4 / 3 * (1 + log($ir)) + sqrt(3)) }")"
  in_range "$work/$ir/summary.json" particles_inside 0 0
done
in_range "$work/200/summary.json" n_kt "$(sed -n 's/^ *"n_kt": \([^,]*\),*$/\1/p' "$work/50/summary.json")" 100

# Soft clay has the same N_kt: by default the cone is as slow in terms of the velocity of shear waves.
for su in 10kPa 1kPa 100Pa; do
  "$1/mps-penetrometer" --cell 0.025 --cohesion $su --threads 1 --out "$work/$su" >/dev/null
done
stiff=$(sed -n 's/^ *"n_kt": \([^,]*\),*$/\1/p' "$work/10kPa/summary.json")
for su in 1kPa 100Pa; do
  in_range "$work/$su/summary.json" n_kt "$(awk "BEGIN { print 0.98 * $stiff }")" "$(awk "BEGIN { print 1.02 * $stiff }")"
done

# Sand of a tenth of the diameter and stiffness bears a tenth of the pressure.
for d in 0.1 0.01; do
  "$1/mps-penetrometer" --law sand --diameter $d --cell "$(awk "BEGIN { print $d / 4 }")" --young "$(awk "BEGIN { print $d * 28e6 }")" \
    --threads 1 --out "$work/sand$d" >/dev/null
done
wide=$(sed -n 's/^ *"q": \([^,]*\),*$/\1/p' "$work/sand0.1/summary.json")
in_range "$work/sand0.01/summary.json" q "$(awk "BEGIN { print 0.097 * $wide }")" "$(awk "BEGIN { print 0.103 * $wide }")"

# Ground under 10 su, the same in all directions, presses the tip by as much before that moves.
"$1/mps-penetrometer" $deep --soil 0.6x0.6x0.45 --start 0.2 --depth 0.26 --law tresca --ir 50 --surcharge 100kPa --k0 1 --out "$work/s" >/dev/null
in_range "$work/s/summary.json" q_at_rest 96e3 104e3
in_range "$work/s/summary.json" vertical_stress 99999 100001
in_range "$work/s/summary.json" particles_inside 0 0

# A path of a few steps has all frames that were asked for.
"$1/mps-penetrometer" --soil 0.2x0.2x0.2 --depth 0.002 --frames 4 --threads 1 --out "$work/short" >/dev/null
[ "$(grep -c '<Time' "$work/short/penetration.xdmf")" -eq 4 ] || fail "a short path lacks frames"

# Cam-Clay with water in its pores: su of the law, (M/2) p (pc/(2 p))^Lambda after K0 = 0.748 for 100 kPa.
"$1/mps-penetrometer" $deep --law mcc --surcharge 100kPa --soil 0.5x0.5x0.4 --start 0.2 --depth 0.26 --out "$work/mcc" >"$work/log"
has "$work/log" "net cone factor N_kt"
su=$(awk 'BEGIN { K = 0.74797; M = 0.92; p = 1e5 * (1 + 2 * K) / 3; q = 1e5 * (1 - K); pc = p + q * q / (M * M * p)
  print M / 2 * p * exp((1 - 0.044 / 0.205) * log(pc / (2 * p))) }')
in_range "$work/mcc/summary.json" su "$(awk "BEGIN { print $su * 0.999 }")" "$(awk "BEGIN { print $su * 1.001 }")"
in_range "$work/mcc/summary.json" n_kt 6.5 20
in_range "$work/mcc/summary.json" volume_ratio_min 0.97 1 # undrained ground keeps its volume
in_range "$work/mcc/summary.json" volume_ratio_max 1 1.03
in_range "$work/mcc/summary.json" particles_inside 0 0

# Half the step leaves the force: transfers that take from the flow at each step make it 22 % higher.
"$1/mps-penetrometer" $deep --law mcc --surcharge 100kPa --soil 0.5x0.5x0.4 --start 0.2 --depth 0.26 --courant 0.45 \
  --out "$work/half" >/dev/null
whole=$(sed -n 's/^ *"n_kt": \([^,]*\),*$/\1/p' "$work/mcc/summary.json")
in_range "$work/half/summary.json" n_kt "$(awk "BEGIN { print 0.9 * $whole }")" "$(awk "BEGIN { print 1.1 * $whole }")"

# Drained, as vD/c_v is well below 1, it bears more than undrained, at pressures that are implicit.
"$1/mps-penetrometer" $deep --law mcc --surcharge 100kPa --soil 0.5x0.5x0.4 --start 0.2 --depth 0.26 --permeability 1e-3 \
  --out "$work/drained" >/dev/null 2>&1
in_range "$work/drained/summary.json" n_kt "$(sed -n 's/^ *"n_kt": \([^,]*\),*$/\1/p' "$work/mcc/summary.json")" 60

# A mesh: an octahedron, tip down, by its STL file. Its widest section is 0.637 of the circle that N is
# reckoned with: 5.14 at least, and the deep cavity's 9.2 at most with corners a cell further out.
awk -v a=50 -v b=-50 'function facet(p, q, r) { printf "facet normal 0 0 0\nouter loop\nvertex %s\nvertex %s\nvertex %s\nendloop\nendfacet\n", p, q, r }
  BEGIN { v[0] = a " 0 " a; v[1] = "0 " a " " a; v[2] = b " 0 " a; v[3] = "0 " b " " a
    print "solid o"
    for (i = 0; i < 4; i++) { facet("0 0 0", v[(i + 1) % 4], v[i]); facet("0 0 " 2 * a, v[i], v[(i + 1) % 4]) }
    print "endsolid o" }' >"$work/mesh.stl"
status=0
"$1/mps-penetrometer" $coarse --tip stl --mesh "$work/mesh.stl" --scale 0.001 --depth 0.08 \
  --out "$work/m" >"$work/log" 2>&1 || status=$?
if ! grep -q "MPS_EMBREE" "$work/log"; then
  [ "$status" -eq 0 ] || fail "mesh: $(cat "$work/log")"
  in_range "$work/m/summary.json" particles_inside 0 0
  in_range "$work/m/summary.json" n_factor 3.27 13.2
  # of other sizes: too small for the cells, larger than the soil
  for try in "1e-6:at least 4 cells of --cell" "0.01:the soil of 0.3 m x 0.3 m must be"; do
    status=0
    "$1/mps-penetrometer" $coarse --tip stl --mesh "$work/mesh.stl" --scale "${try%%:*}" \
      --depth 0.08 --out "$work/m" >/dev/null 2>"$work/log" || status=$?
    [ "$status" -eq 1 ] || fail "mesh of scale ${try%%:*}: exit code $status"
    has "$work/log" "${try#*:}"
  done
fi
