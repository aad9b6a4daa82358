# density.gp - density.csv.   first, second: title; rho (kg/m^3); depth (m)
width = 700; height = 640
load 'style.gp'
set title named(first, second)
set xlabel 'density (kg/m^3)'
set ylabel 'height above the bed (m)'
set xrange [0:1.3*rho]
set yrange [0:*]
set arrow 1 from rho,graph 0 to rho,graph 1 nohead dashtype '--' linecolor rgb red
plot 'density.csv' using 2:1 with lines linetype 1 linewidth 1.6 title 'particles', \
  NaN dashtype '--' linecolor rgb red title 'water', depth dashtype '-.' linecolor rgb '#666666' title 'depth at rest'
