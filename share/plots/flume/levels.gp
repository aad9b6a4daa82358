# levels.gp - gauges.csv.   shown: array gauge[] of numbers from 0, array at[] (m); from, end (s); unit: of levels over m; high (m): of the waves
width = 1000; height = 120 + 230*shown
load 'style.gp'
set multiplot layout shown,1
set xrange [from:end]
set ylabel 'level ('.(unit == 1 ? 'm' : 'mm').')'
set lmargin 10
set ytics tics_of(2.0*unit*high, 6)
set key outside top center horizontal
do for [k=1:shown] {
  if (k == shown) { set xlabel 'time t (s)' }
  plot 'gauges.csv' using 1:(unit*column(2*gauge[k] + 3)) with lines linewidth 3 linecolor rgb '#f0b27a' title sprintf('target without reflection, x = %g m', at[k]), \
    '' using 1:(unit*column(2*gauge[k] + 2)) with lines linetype 1 title 'MPS'
}
unset multiplot
