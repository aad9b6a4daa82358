# deflection.gp - wall.csv at the time t (s), displacements times 10^6.   crest (m): displacement; front, thickness, high (m): of the wall; spacing (m)
width = 560; height = 760
load 'style.gp'
most = 1e6*abs(crest) > 0.02 ? 1e6*abs(crest) : 0.02
set title sprintf('Wall at t = %.2f s, displacement times 10^6', t)
set xlabel 'x (m)'
set ylabel 'y (m)'
set size ratio -1
set xrange [front - 0.05:front + thickness + most + 0.05]
set yrange [-2*spacing:1.3*high]
set xtics 0.1
set label 1 sprintf('crest: %.3g {/Symbol m}m', 1e6*crest) at front + 0.5*thickness + 0.5*most,1.06*high center offset 0,1 textcolor rgb blue
plot 'wall.csv' using 1:2 with points pointtype 6 pointsize 0.7 linecolor rgb '#bbbbbb' title 'unloaded', \
  '' using ($1 + 1e6*$3):($2 + 1e6*$4) with points linetype 1 pointsize 0.7 title 'bent'
