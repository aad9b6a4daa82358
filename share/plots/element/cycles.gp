# cycles.gp - path.csv over the cycles.   drained; first: effective stress (Pa)
width = 900; height = 640
load 'style.gp'
set title (drained ? 'Volume strain over cycles of shear' : 'Excess pore pressure over cycles of shear')
set xlabel 'cycles'
set ylabel (drained ? 'contraction of the volume (%)' : 'r_u, excess pore pressure over the first effective stress')
set yrange [0:*]
if (!drained) { set yrange [0:1.05<*] }
unset key
plot 'path.csv' using 'cycles':(drained ? -100*log(column('volume_ratio')) : column('u')/first) with lines linetype 1 linewidth 1.6
