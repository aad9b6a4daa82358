# force.gp - force.csv, and below it gauges.csv where there are levels.   end (s); still (N); linear: linear.csv is there
#   gauges: array names[], 0: none; noise (mm): a scale of levels at least
width = 1000; height = gauges ? 700 : 400
load 'style.gp'
set multiplot layout gauges ? 2 : 1,1
set xrange [0:end]
set xlabel 'time t (s)'
set ylabel 'force on the wall (N)'
set lmargin 12
set yrange [*<0.98*still:1.02*still<*]
theory = linear ? "'linear.csv' using 1:2 with lines linewidth 3 linecolor rgb '#f0b27a' title 'linear potential flow', " : ''
eval 'plot '.theory."'force.csv' using 1:3 with lines linetype 1 title 'right wall', still with lines dashtype '--' linecolor rgb grey title 'water at rest'"
if (gauges) {
  set ylabel 'level (mm)'
  set yrange [*<-noise:noise<*]
  plot for [k=1:gauges] 'gauges.csv' using 1:(1e3*column(k + 1)) with lines linetype k title names[k]
}
unset multiplot
