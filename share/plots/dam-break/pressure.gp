# pressure.gp - pressure.csv beside the mean of Buchner's experiment.   spacing: over H; end: of t (g/H)^(1/2)
width = 1000; height = 520
load 'style.gp'
set title sprintf('Impact of a column: pressure on the far wall at 0.2 H, spacing %.3g H', spacing)
set xlabel 't (g/H)^{1/2}'
set ylabel 'p/({/Symbol r} g H)'
set xrange [0:end]
set yrange [0:1.4<*]
set samples 2000
set object 1 rectangle from 3.3,graph 0 to 4.9,graph 1 fillcolor rgb '#eef3fa' fillstyle solid noborder behind clip
plot 'pressure.csv' using 't_scaled':'pressure_scaled' with lines linecolor rgb '#8fb3dd' linewidth 0.7 title 'MPS', \
  '' using 't_scaled':'mean_scaled' with lines linetype 1 title 'mean over 0.1', \
  x < 3.3 || x > 4.9 ? NaN : 0.545 with lines dashtype '--' linecolor rgb red title 'experiment, mean of Buchner 2002'
