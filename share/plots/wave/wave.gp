# wave.gp - traces of receivers.csv, depth downwards.   first, second: title; receivers, depth[], peak[] (m/s^2)
#   end (s): of the record; $theory: t, depth of the pulse; known: it has a theory
width = 1200; height = 900
load 'style.gp'
deepest = depth[receivers]
most = 0.0
do for [k=1:receivers] { if (peak[k] > most) { most = peak[k] } }
if (!(most > 0)) { most = 1.0 }
# Few traces may be as high as their distance, many must overlap to be seen.
gap = deepest/(receivers - 1)
if (gap < deepest/20.0) { gap = deepest/20.0 }
scale = gap/most
bar = round_down(most)
set title named(first, second) offset 0,0.3
set xlabel 'time t (s)'
set ylabel 'depth of the receiver below the surface'
set y2label 'peak acceleration (m/s^2)' offset 0,0

set lmargin 16; set rmargin 11; set tmargin 4.5
set xrange [0:end]
set yrange [deepest + 1.3*most*scale:-1.3*most*scale]
set y2range [deepest + 1.3*most*scale:-1.3*most*scale]
set ytics () ; set y2tics ()
every_k = (receivers + 19)/20
do for [k=1:receivers:every_k] {
  set ytics add (sprintf('%.4g m', depth[k]) depth[k])
  set y2tics add (sprintf('%#.3g', peak[k]) depth[k])
}
# the scale's place: over the trace of the surface, before the pulse is there
above = -0.65*most*scale
set arrow from graph 0.03, first above + scale*bar*0.5 to graph 0.03, first above - scale*bar*0.5 heads size screen 0.006,90 front linewidth 1.5
set label sprintf('%g m/s^2', bar) at graph 0.047, first above
plot for [k=1:receivers] 'receivers.csv' using 1:(depth[k] - scale*column(k + 1)) with lines linetype 1 title k == 1 ? 'MPS' : '', \
  $theory using 1:2 with lines linetype 2 dashtype '--' title known ? 'pulse by theory' : ''
