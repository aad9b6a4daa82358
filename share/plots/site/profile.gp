# profile.gp - largest values by depth from profile.csv.   depth (m); wet: with r_u; array joints[]: depths of layers (m), the first one 0
#   array most[4]: of acceleration (m/s^2), strain (%), r_u, stress (kPa)
width = 1100; height = 700
load 'style.gp'
array names[4] = ['largest acceleration (m/s^2)', 'largest shear strain (%)', 'largest r_u, pore pressure ratio', 'largest shear stress (kPa)']
set multiplot layout 1,3
set yrange [depth:0]
unset key
set bmargin 4
do for [k=2:|joints|] { set arrow k from graph 0, first joints[k] to graph 1, first joints[k] nohead linecolor rgb grey dashtype 3 }
do for [k=1:3] {
  q = k == 3 && !wet ? 4 : k
  top = most[q] > 0 ? most[q] : 1e-12
  set xlabel names[q]
  set ylabel (k == 1 ? 'depth (m)' : '')
  set xrange [0:1.1*top]
  set xtics tics_of(top, 4)
  plot 'profile.csv' using (q == 1 ? $3 : q == 2 ? 100*$6 : q == 3 ? $8 : 1e-3*$7):1 with lines linetype 1
}
unset multiplot
