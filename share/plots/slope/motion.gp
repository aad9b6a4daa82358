# motion.gp - motion.csv, the displacement in each trial.   first, second: title; trials; array factor[], failed[] of each
width = 1000; height = 680
load 'style.gp'
set title named(first, second)
set xlabel 'time t (s)'
set ylabel 'displacement over the height'
set yrange [0:*]
fate(k) = failed[k] ? 'fails' : 'stands'
plot for [k=1:trials] 'motion.csv' using ($1 == k ? $3 : NaN):4 with lines linetype (failed[k] ? 2 : 1) dashtype 1 + k%5 title sprintf('F = %.3f %s', factor[k], fate(k))
