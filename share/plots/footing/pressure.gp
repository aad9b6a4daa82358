# pressure.gp - the pressure below the footing over its settlement.   first, second: title; file: the table;
#   undeformed, exact, smooth, rough (kPa), NaN: none; source, smooth_source, rough_source: of these
width = 1000; height = 680
load 'style.gp'
set title named(first, second)
set xlabel 'settlement (mm)'
set ylabel 'pressure q (kPa)'
set yrange [0:*]
is(v) = v == v
plot file using 1:2 with lines linetype 1 title is(undeformed) ? 'WLS-MPM, as the ground deforms' : 'WLS-MPM', \
  is(undeformed) ? undeformed : NaN linetype 1 dashtype '..' title is(undeformed) ? 'WLS-MPM, capacity of the undeformed ground' : '', \
  is(exact) ? exact : NaN linetype 2 dashtype '--' title is(exact) ? source : '', \
  is(smooth) ? smooth : NaN linetype 2 dashtype '--' title is(smooth) ? smooth_source : '', \
  is(rough) ? rough : NaN linetype 2 dashtype '-.' title is(rough) ? rough_source : ''
