# force.gp - force.csv.   end (s); still, goda (N/m), NaN: none
width = 1000; height = 460
load 'style.gp'
set title 'Horizontal force of the water on the structure'
set xlabel 'time t (s)'
set ylabel 'force (N per m)'
set xrange [0:end]
plot still with lines dashtype '--' linecolor rgb grey title 'water at rest', \
  goda == goda ? goda : NaN with lines dashtype '--' linecolor rgb red title goda == goda ? 'Goda' : '', \
  'force.csv' using 1:4 with lines linetype 1 title 'MPS'
