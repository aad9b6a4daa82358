# pressure.gp - pressure.csv at the time t (s).   depth (m); H (m): of the waves, NaN: no theory
width = 640; height = 720
load 'style.gp'
set title sprintf('Pressure on the wall, t = %.2f s', t)
set xlabel 'pressure (kPa)'
set ylabel 'height above the bed (m)'
set xrange [0:*]
set yrange [0:1.5*depth]
set arrow 1 from graph 0, first depth to graph 1, first depth nohead linecolor rgb '#4aa3c7'
set label 1 'water at rest' at graph 0.97, first depth right offset 0,0.6 textcolor rgb '#4aa3c7'
plot 'pressure.csv' using (H == H ? $3*1e-3 : NaN):1 with lines linetype 2 dashtype '--' title H == H ? sprintf('Sainflou, H = %.3f m', H) : '', \
  '' using ($2*1e-3):1 with points linetype 1 pointsize 0.9 title 'MPS'
