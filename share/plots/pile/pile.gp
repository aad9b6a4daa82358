# pile.gp - load and plug along the path (Nakamura, Figure 23) from load.csv, and the soil at the end.
#   first, second: title; depth (m); stress, stress_bytes, stress_lowest, stress_highest, stress_most: of the pressure (kPa)
#   and the variables of maps.gp of the plastic shear strain; cover(k)
panel = 480.0*(x1 - x0)/(y1 - y0)
width = int(870 + 2*(panel + 190)); height = 760
load 'style.gp'
place(l, r) = sprintf('set lmargin at screen %g; set rmargin at screen %g; set tmargin at screen 0.83; set bmargin at screen 0.25', l/width, r/width)
set multiplot title named(first, second) font ',17'
eval place(120.0, 460.0)
set title 'Load'
set xlabel 'force (kN)'
set ylabel 'depth of the tip (m)'
set xrange [0:*]
set yrange [depth:0]
set key at screen 100.0/width, 0.125 left top vertical maxrows 2 reverse Left samplen 1.8 font ',13'
plot 'load.csv' using ($2/1e3):1 with lines linetype 6 linewidth 0.7 title 'total, each row', \
  '' using ($6/1e3):1 with lines linecolor rgb '#222222' title 'total', '' using ($7/1e3):1 with lines linetype 2 title 'tip', \
  '' using ($8/1e3):1 with lines linetype 1 title 'inside', '' using ($9/1e3):1 with lines linetype 3 title 'outside', \
  '' using ($13/1e3):1 with lines linetype 3 dashtype '--' title 'outside, K_0 {/Symbol s}_v {/Symbol m}'
eval place(545.0, 780.0)
set title 'Soil inside'
set xlabel 'its top above the tip (m)'
set ylabel ''
set key inside right top vertical maxrows 2
plot 'load.csv' using 11:1 with lines linetype 1 title 'plug', '' using 1:1 with lines linetype 6 dashtype '--' title 'no plugging'
unset key
unset grid
eval blues
set size ratio -1
set xrange [x0:x1]
set yrange [y0:y1]
set xtics tics_of(x1 - x0, panel/45)
set xlabel 'r (m)'
eval cover(maps - 1)
do for [k=0:1] {
  at = 890.0 + k*(panel + 190)
  eval place(at, at + panel)
  set ylabel (k == 0 ? 'z (m)' : '')
  set title (k == 0 ? 'Mean pressure (kPa)' : 'Plastic shear strain (-)')
  set colorbox user origin screen (at + panel + 12)/width, screen 0.3 size screen 14.0/width, screen 0.4
  strain_highest = cb_highest; strain_lowest = cb_lowest; strain_most = cb_most
  if (k == 0) { cb_lowest = stress_lowest; cb_highest = stress_highest; cb_most = stress_most }
  eval colours
  eval 'plot '.frame(k == 0 ? stress : image, image_bytes, maps - 1)
  cb_lowest = strain_lowest; cb_highest = strain_highest; cb_most = strain_most
}
unset multiplot
