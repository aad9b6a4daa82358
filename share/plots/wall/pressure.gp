# pressure.gp - pressure.csv beside theory.   first, second: title; plain: one layer; theory: K, NaN: none, of source;
#   cracked: K by Rankine with a tension crack, NaN: none
width = 1000; height = 640
load 'style.gp'
set title named(first, second)
set xlabel 'path of the wall over its height'
set ylabel 'K, force across the wall over '.(plain ? '{/Symbol g}H^2/2' : 'the weight above, summed over H')
set yrange [0:*]
plot 'pressure.csv' using 1:3 with lines linetype 1 linewidth 1.6 title 'WLS-MPM', \
  theory == theory ? theory : NaN dashtype '--' linecolor rgb red title theory == theory ? source : '', \
  cracked == cracked ? cracked : NaN dashtype '.' linecolor rgb red title cracked == cracked ? 'Rankine with a tension crack' : ''
