# structure.gp - structure.csv.   first: title; y_name; end (s); unit; linear: its third column is linear theory; else
#   amplitude, omega: of a first mode, NaN: none; rest: a value, NaN: none
width = 1000; height = 460
load 'style.gp'
set title first
set xlabel 'time t (s)'
set ylabel y_name
set xrange [0:end]
set samples 1000
mode(t) = linear || amplitude != amplitude ? NaN : unit*amplitude*(cos(omega*t) - 1)
plot 'structure.csv' using 1:(linear ? $3*unit : NaN) with lines linewidth 3 linecolor rgb '#f0b27a' title linear ? 'linear potential flow' : '', \
  mode(x) with lines linewidth 3 linecolor rgb '#f0b27a' title !linear && amplitude == amplitude ? 'first mode of potential flow' : '', \
  !linear && rest == rest ? rest : NaN with lines dashtype '--' linecolor rgb red title !linear && rest == rest ? 'at rest' : '', \
  'structure.csv' using 1:($2*unit) with lines linetype 1 title 'MPS'
