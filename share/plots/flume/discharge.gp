# discharge.gp - discharge.csv.   end, from (s); eurotop (m^2/s), NaN: none; thin: events too low for particles
width = 1000; height = 420
load 'style.gp'
set title 'Water that has passed the crest'
set xlabel 'time t (s)'
set ylabel 'volume (l per m)'
set xrange [0:end]
set yrange [0:*]
plot eurotop == eurotop && x >= from ? 1e3*eurotop*(x - from) : NaN with lines linewidth 3 linecolor rgb '#f0b27a' title eurotop == eurotop ? 'EurOtop, mean' : '', \
  'discharge.csv' using 1:(1e3*$2) with lines linetype 1 title 'MPS', \
  '' using 1:(thin ? 1e3*($2 + $6) : NaN) with lines linetype 1 dashtype '-' title thin ? 'with events too low for particles' : ''
