# convergence.gp - convergence.csv.   array names[4] of the methods
width = 900; height = 600
load 'style.gp'
set title 'Tip deflection against the number of particles or nodes'
set xlabel 'particles or nodes'
set ylabel 'error of the deflection of the tip (%)'
set logscale x
set xzeroaxis linewidth 1.2
set offsets 0, 0, graph 0.05, graph 0.05
plot for [k=1:4] 'convergence.csv' using 1:k + 3 with linespoints linetype k pointtype 9 - 2*k title names[k]
