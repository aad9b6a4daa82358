# spectrum.gp - spectrum.csv.   first: title
width = 900; height = 520
load 'style.gp'
set title first
set xlabel 'frequency (Hz)'
set ylabel 'density (mm^2 s)'
set yrange [0:*]
plot 'spectrum.csv' using 1:(1e6*$4) with lines linewidth 3 linecolor rgb '#f0b27a' title 'linear target', \
  '' using 1:(1e6*$2) with lines linetype 1 title 'incident', '' using 1:(1e6*$3) with lines linetype 2 title 'reflected'
