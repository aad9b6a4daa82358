# q_strain.gp - path.csv against strain.   law: line of the title; x_name; limit of q (kPa), NaN: none
width = 900; height = 640
load 'style.gp'
set title named('Deviator stress and pore pressure', law)
set xlabel x_name
set ylabel 'deviator stress q, pore pressure u (kPa)'
set offsets 0, 0, graph 0.05, graph 0.05
plot 'path.csv' using (100*column('strain')):(column('q')/1e3) with lines linetype 1 linewidth 1.6 title 'q', \
  '' using (100*column('strain')):(column('u')/1e3) with lines linetype 3 title 'u', \
  limit == limit ? limit : NaN dashtype '--' linecolor rgb red title limit == limit ? 'limit of q' : ''
