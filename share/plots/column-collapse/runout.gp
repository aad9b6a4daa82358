# runout.gp - cases.csv beside the laws of Lube et al. and of glass beads.   second: line of the title; ring: of a cylinder
width = 1200; height = 560
load 'style.gp'
low(x)  = ring ? (x < 1.7 ? 1.24*x : NaN) : x < 1.8 ? 1.2*x : NaN
high(x) = ring ? (x > 1.7 ? 1.6*sqrt(x) : NaN) : x > 2.8 ? 1.9*x**(2.0/3) : NaN
beads(x) = ring ? NaN : x < 3 ? 1.8*x : 2.3*x**(2.0/3)
top(x) = ring ? (x < 0.85 ? x : 0.88*x**(1.0/6)) : x < 1 ? x : x**0.4
law = 'sand, Lube et al. '.(ring ? '2004' : '2005')
set multiplot layout 1,2 title named('Collapse of a column on a bed', second)
set logscale xy
set xtics (0.5, 1, 2, 5, 10)
set ytics (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20)
set xrange [0.3:10]
set xlabel 'a = H_0/L_0'
set ylabel 'run-out (L - L_0)/L_0'
set yrange [*<0.2:20]
if (ring) {
  plot low(x) with lines linetype 2 title law, high(x) with lines linetype 2 notitle, \
    'cases.csv' using 2:5 with points linetype 1 pointsize 1.4 title 'WLS-MPM'
} else {
  plot beads(x) with lines dashtype '--' linecolor rgb grey title 'glass beads, Lajeunesse et al. 2005', \
    low(x) with lines linetype 2 title law, high(x) with lines linetype 2 notitle, \
    'cases.csv' using 2:5 with points linetype 1 pointsize 1.4 title 'WLS-MPM'
}
set ylabel 'final height H/L_0'
set yrange [0.2:5]
plot top(x) with lines linetype 2 title law, 'cases.csv' using 2:7 with points linetype 1 pointsize 1.4 title 'WLS-MPM'
unset multiplot
