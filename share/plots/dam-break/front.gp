# front.gp - front.csv beside experiment.csv.   n2 = n^2, base (m); how, method: of the run; shift: of the clock, NaN: none
width = 1200; height = 560
load 'style.gp'
set multiplot layout 1,2 title named(sprintf('Collapse of a water column, n^2 = %d', n2), sprintf('base a = %.4g m, %s', base, how))
points = "with points pointtype 6 pointsize 1.2 linecolor rgb red title 'Martin and Moyce 1952'"
set xrange [0:4.2]
set yrange [1:5.2]
set xlabel 'T = t (n^2 g/a)^{1/2}'
set ylabel 'front Z = x/a'
later = shift == shift ? "'clock set at Z = 1.44'" : "''"
plot 'experiment.csv' using 1:2 @points, 'front.csv' using 'T':'Z' with lines linetype 1 title method, \
  '' using (column('T') + shift):'Z' with lines dashtype '--' linecolor rgb blue title @later
set xrange [0:6]
set yrange [0:1.05]
set xlabel '{/Symbol t} = t (g/a)^{1/2}'
set ylabel 'height at the wall H = y/(n^2 a)'
plot 'experiment.csv' using 3:4 @points, 'front.csv' using 'tau':'H' with lines linetype 1 title method
unset multiplot
