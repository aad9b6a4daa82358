# pressures.gp - faces.csv at the time t (s) of the largest force: left the faces that are no underside, over the height; right
#   the base of a caisson (body) on rock (bedded).   base, heel, front (m); half a spacing; foot (kPa); goda: $goda of pressure (kPa) and height (m), pu (kPa)
width = body ? 1200 : 700; height = 620
load 'style.gp'
set multiplot layout 1,body ? 2 : 1
set title sprintf('Pressure above that of water at rest, t = %.2f s', t)
set xlabel 'pressure (kPa)'
set ylabel 'y (m)'
set xrange [*<0:*]
set xtics font ',11'
theory = goda ? "$goda using 1:2 with linespoints linetype 2 title 'Goda', " : ''
if (body) {
  eval 'plot '.theory."'faces.csv' using ($1 < heel - half && $2 > base + 1e-6 ? 1e-3*$4 : NaN):2 with points linetype 1 pointsize 0.7 title 'MPS, front', '' using ($1 > heel - half && $2 > base + 1e-6 ? 1e-3*$4 : NaN):2 with points linetype 1 pointtype 6 pointsize 0.7 title 'MPS, rear'"
  set title 'Uplift below the caisson'
  set xlabel 'x (m)'
  set ylabel 'pressure (kPa)'
  set xrange [*:*]
  set yrange [*<0:*]
  line(x, top) = x < front || x > heel ? NaN : top*(heel - x)/(heel - front)
  plot [front:heel] goda ? line(x, pu) : NaN with lines linetype 2 title goda ? 'Goda' : '', \
    line(x, foot) with lines dashtype '--' linecolor rgb grey title 'triangle from the foot', \
    'faces.csv' using (abs($2 - base) < 1e-6 && $1 > front - half ? $1 : NaN):(1e-3*$4) with points linetype 1 pointsize 0.7 title 'MPS, '.(bedded ? 'in the rock' : 'below it')
} else {
  eval 'plot '.theory."'faces.csv' using (1e-3*$4):2 with points linetype 1 pointsize 0.7 title 'MPS'"
}
unset multiplot
