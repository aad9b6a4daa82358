#!/bin/sh
# element.sh DIRECTORY: mps-element with two clays against an independent integration of modified
# Cam-Clay, other laws against their limits, and stages of a file against the paths by name.
. "$(dirname "$0")/checks.sh"
run() { name=$1; shift; "$element" "$@" --out "$work/$name" >"$work/log" || fail "$*"; }
element=$1/mps-element
stiff="--law mcc --M 1.2 --lambda 0.10 --kappa 0.02 --poisson 0.2 --e0 0.8 --p0 50kPa --ocr 4"
soft="--law mcc --M 0.92 --lambda 0.205 --kappa 0.044 --poisson 0.25 --e0 1.4 --p0 100kPa --ocr 1"

run cu $stiff --path cu --strain 0.2
is "$work/cu/path.csv" p -1 87055 87
is "$work/cu/path.csv" q -1 104466 104
is "$work/cu/path.csv" pc -1 174110 174
is "$work/cu/path.csv" strain -1 0.2 1e-9
for name in q_p q_strain e_p; do picture "$work/cu/$name.png" 900x640 1f4e8c; done
page "$work/cu"
in_range "$work/cu/summary.json" q_limit 104465 104467
run oedometer $soft --path oedometer --strain 0.1
is "$work/oedometer/path.csv" szz -1 -337773 338
is "$work/oedometer/path.csv" sxx -1 -252643 253
run cd $soft --path cd --strain 0.1
is "$work/cd/path.csv" q -1 90000 90
is "$work/cd/path.csv" sxx -1 -100000 1
is "$work/cd/path.csv" void_ratio -1 1.27397 1e-4 # 2.4 exp(-0.053939) - 1
run shear $stiff --path shear --strain 0.1
is "$work/shear/path.csv" sxy -1 60329 60
is "$work/shear/path.csv" syy -1 -87573 88
run iso $soft --path iso --strain 0.02
is "$work/iso/path.csv" p -1 126089 126
run plane $soft --path ps-undrained --strain 0.5
in_range "$work/plane/summary.json" q 53325 53432 # sqrt(3) times su 30.818 kPa

# Beyond the strain at which no pores are left the e-ln p line goes on: a warning says so.
"$element" $soft --path oedometer --strain 1 --out "$work/closed" >"$work/log" 2>&1
has "$work/log" "there are no pores left"
has "$work/closed/summary.json" "there are no pores left"

# Loops of the small-strain law: half of G0 is left at the reference strain, the damping of Masing's
# hyperbola there is 0.1448; a sixth of G0 and 0.3437 at five times it.
small="--law smallstrain --shear-modulus 50MPa --poisson 0.25 --reference-strain 1e-3 --path cyclic --steps 4000"
run loop $small --strain 1e-3 --cycles 3
in_range "$work/loop/summary.json" secant_modulus 24.7e6 25.3e6
in_range "$work/loop/summary.json" damping_ratio 0.136 0.154
run wide $small --strain 5e-3
in_range "$work/wide/summary.json" secant_modulus 8.23e6 8.43e6
in_range "$work/wide/summary.json" damping_ratio 0.335 0.353
for name in loop q_strain; do picture "$work/loop/$name.png" 900x640 1f4e8c; done

# Cyclic sand, Dr 45 %: ten cycles of 0.2 % under constant stresses contract by the sum of Byrne's
# recursion (an awk of its own); the volume by as much where the vertical stress alone is held at K0.
sand="--law cyclicsand --young 80MPa --phi 35 --relative-density 0.45 --threshold 0 --path cyclic"
wanted=$(awk 'BEGIN { c = 7600*45^-2.5; e = 0; for (n = 0; n < 21; n++) { g = n ? 2e-3 : 1e-3
  e += 0.5*c*g*exp(-0.4/c*e/g) } printf "%.8f", e }')
run settles $sand --p0 300kPa --k0 0.428571 --strain 2e-3 --cycles 10 --drained --steps 400
is "$work/settles/path.csv" contraction -1 "$wanted" 2e-5
is "$work/settles/path.csv" volume_ratio -1 "$(awk "BEGIN { print exp(-$wanted) }")" 5e-5
run liquefies $sand --p0 100kPa --csr 0.15 --cycles 40
in_range "$work/liquefies/summary.json" cycles_to_liquefaction 2 20
has "$work/liquefies/summary.json" '"outcome": "finished"'
run cell --law cyclicsand --path cyclic-triaxial --csr 0.2 --cycles 40 --relative-density 0.45 --young 80MPa --phi 35
in_range "$work/cell/summary.json" cycles_to_liquefaction 2 20
is "$work/cell/cycles.csv" stress_amplitude -1 40000 1
for name in loop cycles; do picture "$work/liquefies/$name.png" 900x640 1f4e8c; done

# A file's stages: the drained test by its lateral stress, then what cannot be.
printf 'ezz,sxx,syy,steps\n-0.1,0,0,1000\n' >"$work/cd.csv"
run file $soft --path-file "$work/cd.csv"
cut -d, -f2-8 "$work/cd/path.csv" >"$work/a"
cut -d, -f2-8 "$work/file/path.csv" >"$work/b"
cmp "$work/a" "$work/b" || fail "the drained test of a file"
printf 'szz,sxx,syy\n-300e3,0,0\n' >"$work/beyond.csv"
if "$element" --law mohrcoulomb --path-file "$work/beyond.csv" --out "$work/beyond" 2>"$work/log"; then
  fail "a stress beyond the strength"
fi
has "$work/log" "no strain gives the target stress"
has "$work/beyond/summary.json" '"outcome": "failed"'
is "$work/beyond/path.csv" q -1 198000 3000 # Kp - 1 times 100 kPa is 200 kPa
# Of clay too, though on the way there are strains that its law refuses.
printf 'sxx,syy,szz,steps\n0,0,-6e5,1000\n' >"$work/beyond.csv"
if "$element" --law mcc --M 1.35 --ocr 1.7 --k0 0.7 --path-file "$work/beyond.csv" --out "$work/clay" 2>"$work/log"; then
  fail "a stress beyond the strength of clay"
fi
has "$work/log" "no strain gives the target stress"

# --ocr 1 is on the yield surface: a first state in extension on that of the Lode option, with
# a M = 1.35 (3 - s)/(3 + s), s = 3 M/(6 + M) = 0.55102, p 73 kPa, q 31.286 kPa.
run first --M 1.35 --lode --p0 73kPa --k0 1.6 --path extension
is "$work/first/path.csv" pc 1 88468.1 0.2

# What contradicts itself, and files that are no text.
refuses() { wanted=$1; shift; if "$element" "$@" --out "$work/no" 2>"$work/log"; then fail "$*"; fi; has "$work/log" "$wanted"; }
refuses "exclude each other" --law vonmises --yield 10kPa --cohesion 5kPa
refuses "of a strength that falls" --law tresca --slip 10mm --band 0.1m
refuses "needs --rate-factor" --law tresca --rate-reference 1
printf 'szz\n-1e3\000\n-2e3\n' >"$work/nul.csv"
refuses "no text" --path-file "$work/nul.csv"

# Other laws: what they bear.
run mises --law vonmises --cohesion 20kPa --path ps-undrained --strain 0.05
is "$work/mises/path.csv" q -1 34641 35
# (sigma1 + sigma3) sin(phi) + 2 c cos(phi) at a mean stress of 90 kPa, in compression and extension.
clay="--law mohrcoulomb --phi 26 --cohesion 5kPa --p0 90kPa"
for name in cu extension; do run $name-mohr $clay --path $name; done
is "$work/cu-mohr/path.csv" q -1 102936 5
in_range "$work/cu-mohr/summary.json" q_limit 102935 102937
is "$work/extension-mohr/path.csv" q -1 76689 5
in_range "$work/extension-mohr/summary.json" q_limit 76688 76690
# Oedometer without dilation: horizontal stress at its least, a third of 450 kPa, at the end of loading;
# back to 160 kPa it falls by nu/(1 - nu) 290 kPa.
printf 'exx,eyy,szz,steps\n0,0,-300e3,500\n0,0,290e3,500\n' >"$work/unload.csv"
run unload --law mohrcoulomb --phi 30 --p0 100kPa --k0 0.5 --poisson 0.15 --path-file "$work/unload.csv"
is "$work/unload/path.csv" sxx 501 -150000 50
is "$work/unload/path.csv" sxx -1 -98824 50
run mohr --law mohrcoulomb --phi 30 --psi 10 --path cd --strain 0.2
is "$work/mohr/path.csv" q -1 200000 1
# Dilation ends at emax less the elastic compression: 1.8 exp(-206.792 kPa/K) - 1, K = 41.67 MPa.
run loose --law mohrcoulomb --phi 38 --psi 12 --e0 0.6 --emax 0.8 --young 50MPa --path cd --strain 0.6
is "$work/loose/path.csv" void_ratio -1 0.791089 2e-6
run soft --law tresca --cohesion 10kPa --residual 0.5 --slip 10mm --band 0.1m --path cu --strain 1 --steps 4000
is "$work/soft/path.csv" q -1 10000 20
run fast --law vonmises --cohesion 10kPa --rate-factor 0.1 --strain-rate 3e-3 --path shear --strain 0.1
is "$work/fast/path.csv" sxy -1 13000 3 # a thousand times the reference
run hooke --law elastic --young 10MPa --poisson 0.25 --path cd --strain 0.01
is "$work/hooke/path.csv" q -1 100000 1
run rubber --law neohookean --path oedometer --strain 0.1 --steps 10000
is "$work/rubber/path.csv" szz -1 -1348399 200
