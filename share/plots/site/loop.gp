# loop.gp - loop.csv.   depth (m)
width = 700; height = 600
load 'style.gp'
set xlabel 'shear strain (%)'
set ylabel 'shear stress (kPa)'
unset key
set title sprintf('At a depth of %.4g m', depth)
plot 'loop.csv' using (100*$2):(1e-3*$3) with lines linetype 1
