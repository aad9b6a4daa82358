# force.gp - force.csv.   end, impulse (s): of the run, of its start; still, crest, trough (N/m), NaN: no theory; H (m): of the waves
width = 1100; height = 560
load 'style.gp'
set title 'Force of the water on the wall'
set xlabel 'time t (s)'
set ylabel 'force (N per m of wall)'
set xrange [0:end]
known = crest == crest
plot still with lines linecolor rgb '#999999' linewidth 1 title 'water at rest', \
  known ? crest : NaN with lines dashtype '--' linecolor rgb red title known ? sprintf('Sainflou, crest (H = %.3f m)', H) : '', \
  known ? trough : NaN with lines dashtype '.' linecolor rgb red title known ? 'Sainflou, trough' : '', \
  'force.csv' using ($1 < impulse ? NaN : $1):2 with lines linecolor rgb '#8fb3dd' linewidth 1 title 'MPS', \
  '' using ($1 < impulse ? NaN : $1):3 with lines linetype 1 title 'below 10 Hz', \
  '' using ($1 < impulse ? NaN : $1):8 with lines linecolor rgb '#e69f00' dashtype '-' title 'linear potential flow'
