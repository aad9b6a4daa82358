# q_p.gp - path.csv as effective stress.   law: line of the title; clay: of modified Cam-Clay, M, first_pc, last_pc (kPa), most (kPa): of p
width = 900; height = 640
load 'style.gp'
set title named('Path of effective stress', law)
set xlabel 'mean effective stress p (kPa)'
set ylabel 'deviator stress q (kPa)'
set offsets graph 0.05, graph 0.05, graph 0.05, 0
p(t, pc) = 0.5*pc*(1 - cos(t))
q(t, pc) = 0.5*M*pc*sin(t)
path = "'path.csv' using (column('p')/1e3):(column('q')/1e3) with lines linetype 1 linewidth 1.6 title 'path', '' every ::::0 using (column('p')/1e3):(column('q')/1e3) with points linetype 1 title 'start'"
if (clay) {
  set xrange [0:1.05*most]
  plot M*x dashtype '--' linecolor rgb grey title 'critical state line', \
    [t=0:pi] '+' using (p($1, first_pc)):(q($1, first_pc)) with lines linetype 4 title 'first yield surface', \
    [t=0:pi] '+' using (p($1, last_pc)):(q($1, last_pc)) with lines linetype 2 title 'last yield surface', @path
} else {
  plot @path
}
