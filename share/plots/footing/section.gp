# section.gp - section.csv, the stresses along a vertical line.   first, second: title; depth (m); strip: an elastic half space too
width = 800; height = 740
load 'style.gp'
set title named(first, second)
set xlabel 'stress, compression positive (kPa)'
set ylabel 'depth (m)'
set yrange [depth:0]
plot 'section.csv' using 2:1 with lines linetype 1 title 'vertical', '' using 3:1 with lines linetype 3 title 'horizontal', \
  '' using 4:1 with lines linetype 2 title 'shear', \
  '' using (strip ? $6 : NaN):1 with lines linetype 1 dashtype '--' title strip ? 'vertical, elastic half space' : ''
