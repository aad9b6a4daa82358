# force.gp - force.csv along the path.   first, second: title; clay: force over that of c; unit (N); runs; space: the first run is in space;
#   parts: tip and shaft; hertz: N at 1 m of a sphere in a half space, NaN: none; above: the run ends above the ground; fallen: it starts above
width = 1000; height = 680
load 'style.gp'
set title named(first, second)
set xlabel 'depth of the lowest point (mm)'
set ylabel (clay ? 'force over c {/Symbol p}D^2/4' : 'force (kN)')
if (above) { set xrange [0:1]; set yrange [0:1] } else { set yrange [0:*]; if (!fallen) { set xrange [0:*] } }
other = runs == 2 ? 'force-axisymmetric.csv' : 'force.csv'
plot 'force.csv' using (1e3*$1):($2/unit) with lines linecolor rgb '#bbbbbb' linewidth 0.7 title 'every row', \
  other using (1e3*$1):(runs == 2 ? $5/unit : NaN) with lines linetype 2 title runs == 2 ? 'total, axisymmetric' : '', \
  'force.csv' using (1e3*$1):($5/unit) with lines linetype 1 title space ? 'total, in space' : 'total, axisymmetric', \
  '' using (1e3*$1):(parts ? $6/unit : NaN) with lines linetype 1 dashtype 2 title parts ? 'its tip' : '', \
  '' using (1e3*$1):(parts ? $7/unit : NaN) with lines linetype 3 dashtype 3 title parts ? 'its shaft' : '', \
  hertz == hertz ? hertz/unit*(1e-3*x)**1.5 : NaN dashtype '--' linecolor black title hertz == hertz ? 'Hertz, half space' : ''
