# e_p.gp - path.csv as volume over log p.   law: line of the title; voids: a void ratio is known; least, most (kPa): of p
#   clay: lines of modified Cam-Clay, n: e of virgin compression at 1 kPa, lambda, critical: the same of critical states
width = 900; height = 640
load 'style.gp'
set title named(voids ? 'Void ratio' : 'Volume', law)
set xlabel 'mean effective stress p (kPa)'
set ylabel (voids ? 'void ratio e' : 'V/V_0')
set logscale x
set xrange [0.7*least:1.4*most]
set offsets 0, 0, graph 0.05, graph 0.05
set xtics ()
do for [power=int(floor(log10(0.7*least))):int(ceil(log10(1.4*most)))] {
  do for [k in '1 2 5'] {
    tic = k*10.0**power
    if (tic >= 0.7*least && tic <= 1.4*most) { set xtics add (sprintf('%.9g', tic) tic) }
  }
}
plot clay ? n - lambda*log(x) : NaN linetype 4 title clay ? 'virgin isotropic compression' : '', \
  clay ? critical - lambda*log(x) : NaN dashtype '--' linecolor rgb grey title clay ? 'critical state line' : '', \
  'path.csv' using (column('p')/1e3):(column(voids ? 'void_ratio' : 'volume_ratio')) with lines linetype 1 linewidth 1.6 title 'path'
